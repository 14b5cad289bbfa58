/* SPDX-License-Identifier: BSD-3-Clause */
/* A strict reader of XML: what it takes, TinyXML takes in the same sense. */
#include "outline.h"

#include <cstring>

static const size_t depth_most = 64;
static const size_t elements_most = 200000;

const std::string *Element::attribute(const char *name) const
{
    for (const Attribute &a : attributes)
        if (a.name == name)
            return &a.value;
    return NULL;
}

namespace
{

struct Reader {
    const std::string &xml;
    size_t at;
    size_t line;
    std::vector<Element> elements;

    explicit Reader(const std::string &text) : xml(text), at(0), line(1)
    {
    }

    char peek() const
    {
        return at < xml.size() ? xml[at] : '\0';
    }

    void advance(size_t bytes)
    {
        for (; bytes && at < xml.size(); bytes--)
            line += xml[at++] == '\n';
    }

    bool begins(const char *word) const
    {
        return xml.compare(at, std::strlen(word), word) == 0;
    }

    /* Behind `end`; `what` is being skipped. */
    void skip_past(const char *end, const char *what)
    {
        size_t found = xml.find(end, at);
        if (found == std::string::npos)
            refuse(DPT_E_SYNTAX, line, "%s that does not end", what);
        advance(found + std::strlen(end) - at);
    }

    static bool is_blank(char c)
    {
        return c == ' ' || c == '\t' || c == '\n' || c == '\r';
    }

    void skip_blanks()
    {
        while (is_blank(peek()))
            advance(1);
    }

    static bool is_name(char c, bool first)
    {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':' ||
               static_cast<unsigned char>(c) >= 0x80 ||
               (!first && ((c >= '0' && c <= '9') || c == '-' || c == '.'));
    }

    std::string name()
    {
        size_t begin = at;
        while (is_name(peek(), at == begin))
            at++;
        if (at == begin)
            refuse(DPT_E_SYNTAX, line, "a name is missing behind '%.12s'",
                   xml.substr(begin > 12 ? begin - 12 : 0, begin > 12 ? 12 : begin).c_str());
        return xml.substr(begin, at - begin);
    }

    void reference(const std::string &raw, size_t *i, std::string *value) const;
    std::string value();
    void attributes(Element *element);
    void read();
};

/* &amp; and its like, at raw[*i]. */
void Reader::reference(const std::string &raw, size_t *i, std::string *value) const
{
    static const struct {
        const char *name;
        char is;
    } known[] = {
        { "&amp;", '&' }, { "&lt;", '<' }, { "&gt;", '>' }, { "&quot;", '"' }, { "&apos;", '\'' }
    };
    for (const auto &k : known) {
        if (raw.compare(*i, std::strlen(k.name), k.name) == 0) {
            *value += k.is;
            *i += std::strlen(k.name);
            return;
        }
    }
    refuse(DPT_E_SYNTAX, line, "'%.16s': only &amp; &lt; &gt; &quot; and &apos; are taken",
           raw.substr(*i, 16).c_str());
}

std::string Reader::value()
{
    char quote = peek();
    if (quote != '"' && quote != '\'')
        refuse(DPT_E_SYNTAX, line, "an attribute's value is not between quotes");
    size_t end = xml.find(quote, at + 1);
    if (end == std::string::npos)
        refuse(DPT_E_SYNTAX, line, "an attribute's value does not end");
    std::string raw = xml.substr(at + 1, end - at - 1), value;
    if (raw.find('<') != std::string::npos)
        refuse(DPT_E_SYNTAX, line, "'<' in an attribute's value: a quote is missing before it");
    for (size_t i = 0; i < raw.size();) {
        if (raw[i] == '&')
            reference(raw, &i, &value);
        else
            value += raw[i++];
    }
    advance(end + 1 - at);
    return value;
}

void Reader::attributes(Element *element)
{
    for (;;) {
        bool apart = is_blank(peek());
        skip_blanks();
        if (peek() == '>' || peek() == '/' || !peek())
            return;
        if (!apart)
            refuse(DPT_E_SYNTAX, line, "<%s>: no space between two attributes",
                   element->tag.c_str());
        std::string word = name();
        skip_blanks();
        if (peek() != '=')
            refuse(DPT_E_SYNTAX, line, "<%s>: attribute %s has no value", element->tag.c_str(),
                   quoted(word).c_str());
        advance(1);
        skip_blanks();
        if (element->attribute(word.c_str()))
            refuse(DPT_E_SYNTAX, line, "<%s>: attribute %s is given twice", element->tag.c_str(),
                   quoted(word).c_str());
        std::string text = value();
        if (element->attributes.size() == 1000)
            refuse(DPT_E_SYNTAX, line, "<%s> has more than 1000 attributes", element->tag.c_str());
        element->attributes.push_back({ word, text });
    }
}

void Reader::read()
{
    std::vector<size_t> open;
    if (begins("\xef\xbb\xbf"))
        at = 3;
    for (;;) {
        while (at < xml.size() && xml[at] != '<') {
            if (open.empty() && !is_blank(xml[at]))
                refuse(DPT_E_FORMAT, line, "not XML: text outside of any element");
            advance(1);
        }
        if (at >= xml.size())
            break;
        if (begins("<!--"))
            skip_past("-->", "a comment");
        else if (begins("<![CDATA["))
            skip_past("]]>", "CDATA");
        else if (begins("<?")) {
            skip_past(">", "a processing instruction");
            if (xml[at - 2] != '?')
                refuse(DPT_E_SYNTAX, line, "a processing instruction with '>' in it");
        } else if (begins("<!"))
            skip_past(">", "a declaration");
        else if (begins("</")) {
            advance(2);
            std::string tag = name();
            skip_blanks();
            if (open.empty() || peek() != '>')
                refuse(DPT_E_SYNTAX, line, "</%.40s> closes nothing", tag.c_str());
            const Element &element = elements[open.back()];
            if (element.tag != tag)
                refuse(DPT_E_SYNTAX, line, "</%.40s> where <%.40s> of line %zu is open",
                       tag.c_str(), element.tag.c_str(), element.line);
            advance(1);
            open.pop_back();
        } else {
            if (open.empty() && !elements.empty())
                refuse(DPT_E_SYNTAX, line, "a second element behind the robot's end");
            if (open.size() == depth_most)
                refuse(DPT_E_SYNTAX, line, "elements within elements, more than %zu deep",
                       depth_most);
            if (elements.size() == elements_most)
                refuse(DPT_E_LIMIT, line, "more than %zu elements", elements_most);
            Element element;
            element.line = line;
            element.parent = open.empty() ? 0 : open.back();
            advance(1);
            element.tag = name();
            attributes(&element);
            bool closed = peek() == '/';
            advance(closed);
            if (peek() != '>')
                refuse(DPT_E_SYNTAX, element.line, "<%.40s> does not end", element.tag.c_str());
            advance(1);
            if (!closed)
                open.push_back(elements.size());
            elements.push_back(element);
        }
    }
    if (!open.empty())
        refuse(DPT_E_TRUNCATED, elements[open.back()].line, "<%.40s> is not closed",
               elements[open.back()].tag.c_str());
}

} // namespace

Outline outline_of(const std::string &xml)
{
    if (xml.empty())
        refuse(DPT_E_FORMAT, 0, "the file is empty");
    size_t line = 1;
    for (char c : xml) {
        line += c == '\n';
        if (static_cast<unsigned char>(c) < 0x20 && !Reader::is_blank(c))
            refuse(DPT_E_FORMAT, line, "a control character: not XML in UTF-8");
    }
    Reader reader(xml);
    reader.read();
    if (reader.elements.empty())
        refuse(DPT_E_FORMAT, 0, "not XML: no element");
    Outline outline;
    outline.elements.swap(reader.elements);
    return outline;
}
