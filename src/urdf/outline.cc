/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/outline.h"

#include <cstring>
#include <exception>
#include <memory>
#include <new>

#include <expat.h>

static const size_t depth_max = 64;
static const size_t elements_max = 200000;
static const size_t attributes_max = 1000; /* TinyXML compares each attribute with all others */

const std::string *Element::attribute(const char *name) const
{
    for (const Attribute &a : attributes)
        if (a.name == name)
            return &a.value;
    return NULL;
}

namespace
{

struct XmlReader {
    XML_Parser parser;
    std::vector<Element> elements;
    std::vector<size_t> open_elements;
    std::exception_ptr fault; /* kept here: no exception may pass through expat */

    size_t line() const
    {
        return XML_GetCurrentLineNumber(parser);
    }

    /* Do the work of a handler. If it throws, keep the exception and stop the parser. */
    template <typename Work> void handle(const Work &work)
    {
        if (fault)
            return;
        try {
            work();
        } catch (...) {
            fault = std::current_exception();
            XML_StopParser(parser, XML_FALSE);
        }
    }

    void begin(const char *tag, const char **attributes)
    {
        if (open_elements.size() == depth_max)
            refuse(DPT_E_SYNTAX, line(), "elements within elements, more than %zu deep", depth_max);
        if (elements.size() == elements_max)
            refuse(DPT_E_LIMIT, line(), "more than %zu elements", elements_max);
        Element element = { tag, line(), open_elements.empty() ? 0 : open_elements.back(), {} };
        for (; *attributes; attributes += 2) {
            if (element.attributes.size() == attributes_max)
                refuse(DPT_E_SYNTAX, line(), "<%.40s> has more than %zu attributes", tag,
                       attributes_max);
            element.attributes.push_back({ attributes[0], attributes[1] });
        }
        open_elements.push_back(elements.size());
        elements.push_back(element);
    }

    /* Throw why the parser stopped. */
    void report_error() const
    {
        const XML_Error code = XML_GetErrorCode(parser);
        if (fault)
            std::rethrow_exception(fault);
        if (code == XML_ERROR_NO_MEMORY)
            throw std::bad_alloc();
        if (elements.empty())
            refuse(DPT_E_FORMAT, line(), "not XML: %s", XML_ErrorString(code));
        if (open_elements.empty())
            refuse(DPT_E_SYNTAX, line(), "%s", XML_ErrorString(code));
        const Element &element = elements[open_elements.back()];
        if (code == XML_ERROR_NO_ELEMENTS)
            refuse(DPT_E_TRUNCATED, element.line, "<%.40s> is not closed", element.tag.c_str());
        refuse(DPT_E_SYNTAX, line(), "%s, within the <%.40s> of line %zu", XML_ErrorString(code),
               element.tag.c_str(), element.line);
    }
};

void XMLCALL on_begin(void *user, const char *tag, const char **attributes)
{
    XmlReader *reader = static_cast<XmlReader *>(user);
    reader->handle([=] { reader->begin(tag, attributes); });
}

/* expat calls this also for the element that stopped the parser, if that is empty. */
void XMLCALL on_end(void *user, const char *)
{
    XmlReader *reader = static_cast<XmlReader *>(user);
    reader->handle([=] { reader->open_elements.pop_back(); });
}

/* A URDF declares no entities. An expat before 2.4 expands nested ones without limit. */
void XMLCALL on_entity(void *user, const char *name, int, const char *, int, const char *,
                       const char *, const char *, const char *)
{
    XmlReader *reader = static_cast<XmlReader *>(user);
    reader->handle([=] {
        refuse(DPT_E_SYNTAX, reader->line(), "entity %s is declared: a URDF has none of its own",
               quoted(name).c_str());
    });
}

} // namespace

Outline outline_of(const std::string &xml)
{
    if (xml.empty())
        refuse(DPT_E_FORMAT, 0, "the file is empty");
    std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(NULL),
                                                                   XML_ParserFree);
    if (!parser)
        throw std::bad_alloc();
    XmlReader reader = { parser.get(), {}, {}, nullptr };
    XML_SetUserData(parser.get(), &reader);
    XML_SetElementHandler(parser.get(), on_begin, on_end);
    XML_SetEntityDeclHandler(parser.get(), on_entity);
    if (XML_Parse(parser.get(), xml.data(), static_cast<int>(xml.size()), 1) != XML_STATUS_OK)
        reader.report_error();
    Outline outline;
    outline.elements.swap(reader.elements);
    return outline;
}

std::string outline_text(const Outline &outline)
{
    const std::vector<Element> &elements = outline.elements;
    std::vector<size_t> open_elements;
    std::string text;
    for (size_t i = 0; i < elements.size(); i++) {
        for (; i && open_elements.back() != elements[i].parent; open_elements.pop_back())
            text += "</" + elements[open_elements.back()].tag + ">";
        open_elements.push_back(i);
        text += "<" + elements[i].tag;
        for (const Attribute &a : elements[i].attributes) {
            text += " " + a.name + "=\"";
            for (char c : a.value)
                text += c == '"'   ? "&quot;"
                        : c == '&' ? "&amp;"
                        : c == '<' ? "&lt;"
                                   : std::string(1, c);
            text += "\"";
        }
        text += ">";
    }
    for (; !open_elements.empty(); open_elements.pop_back())
        text += "</" + elements[open_elements.back()].tag + ">";
    return text;
}
