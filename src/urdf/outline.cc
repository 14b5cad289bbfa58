/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/outline.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <expat.h>
#include <memory>
#include <new>

/* Longer than dpt_diag.text, into which it is cut to fit. */
static const size_t text_max = 512;

static std::string one_line(std::string text)
{
    for (char &c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text;
}

static std::string format_text(const char *format, va_list arguments)
{
    char text[text_max];
    vsnprintf(text, sizeof text, format, arguments);
    return one_line(text);
}

std::string line_of_text(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    std::string text = format_text(format, arguments);
    va_end(arguments);
    return text;
}

void refuse(dpt_result code, size_t line, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    Fault fault = { code, line, format_text(format, arguments) };
    va_end(arguments);
    throw fault;
}

/* Is the byte at `at` a continuation byte of a UTF-8 character? */
static bool is_inside_character(const std::string &text, size_t at)
{
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
}

/* The text between quotes. If it is longer than head + tail bytes, its middle is cut out. */
static std::string shortened(const std::string &text, size_t head, size_t tail)
{
    if (text.size() <= head + tail)
        return "'" + one_line(text) + "'";
    while (head && is_inside_character(text, head))
        head--;
    size_t tail_begin = text.size() - tail;
    while (is_inside_character(text, tail_begin))
        tail_begin++;
    return "'" + one_line(text.substr(0, head)) + "..." + one_line(text.substr(tail_begin)) + "'";
}

std::string quoted(const std::string &name)
{
    return shortened(name, 40, 0);
}

void refuse_path(dpt_result code, size_t line, const std::string &owner, const std::string &path,
                 const std::string &reason)
{
    const size_t min_path_bytes = 32;
    size_t path_bytes = sizeof(dpt_diag::text) - sizeof "'...'";
    std::string prefix = owner + ": ";
    if (prefix.size() + min_path_bytes + reason.size() > path_bytes)
        prefix.clear();
    path_bytes -= std::min(path_bytes - min_path_bytes, prefix.size() + reason.size());
    refuse(code, line, "%s%s%s", prefix.c_str(),
           shortened(path, path_bytes / 3, path_bytes - path_bytes / 3).c_str(), reason.c_str());
}

/* ---- elements ---- */

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

/* ---- the tree of links ---- */

namespace
{

const size_t none = static_cast<size_t>(-1);

struct LinkTree {
    const Outline &outline;
    std::vector<size_t> parent_joint; /* of each link; none: it is the child of no joint */
    std::vector<std::vector<size_t>> children;

    std::string link_name(size_t link) const
    {
        return quoted(*outline.elements[outline.links[link]].attribute("name"));
    }

    std::string joint_name(size_t joint) const
    {
        return quoted(*outline.elements[outline.joints[joint]].attribute("name"));
    }

    void attach(size_t joint, size_t parent_link, size_t child_link);
    void check_root() const;
};

void LinkTree::attach(size_t joint, size_t parent_link, size_t child_link)
{
    size_t line = outline.joint_line(joint);
    if (parent_link == none || child_link == none)
        refuse(DPT_E_SYNTAX, line, "joint %s has no %s", joint_name(joint).c_str(),
               parent_link == none ? "parent" : "child");
    if (parent_joint[child_link] != none)
        refuse(DPT_E_SYNTAX, line,
               "joint %s: its child %s is that of joint %s already: a URDF is a tree",
               joint_name(joint).c_str(), link_name(child_link).c_str(),
               joint_name(parent_joint[child_link]).c_str());
    parent_joint[child_link] = joint;
    children[parent_link].push_back(child_link);
}

void LinkTree::check_root() const
{
    std::vector<size_t> pending;
    for (size_t i = 0; i < parent_joint.size(); i++) {
        if (parent_joint[i] != none)
            continue;
        if (!pending.empty())
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on no joint, as the root %s does: join them",
                   link_name(i).c_str(), link_name(pending[0]).c_str());
        pending.push_back(i);
    }
    std::vector<bool> is_reached(parent_joint.size());
    while (!pending.empty()) {
        size_t at = pending.back();
        pending.pop_back();
        is_reached[at] = true;
        pending.insert(pending.end(), children[at].begin(), children[at].end());
    }
    for (size_t i = 0; i < parent_joint.size(); i++)
        if (!is_reached[i])
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on itself, by joint %s: a URDF is a tree", link_name(i).c_str(),
                   joint_name(parent_joint[i]).c_str());
}

} // namespace

void outline_check_tree(const Outline &outline)
{
    const size_t links = outline.links.size(), joints = outline.joints.size();
    if (!links)
        refuse(DPT_E_SYNTAX, outline.elements[0].line, "the robot has no link");
    LinkTree tree = { outline, std::vector<size_t>(links, none),
                      std::vector<std::vector<size_t>>(links) };
    std::vector<size_t> joint_of(outline.elements.size(), none), parent_link(joints, none),
        child_link(joints, none);
    for (size_t j = 0; j < joints; j++)
        joint_of[outline.joints[j]] = j;
    for (const Element &e : outline.elements) {
        const size_t joint = joint_of[e.parent];
        const std::string *link = e.attribute("link");
        if (joint == none || !link || (e.tag != "parent" && e.tag != "child"))
            continue;
        auto found = outline.link_named.find(*link);
        if (found == outline.link_named.end())
            refuse(DPT_E_SYNTAX, e.line, "joint %s: its %s %s is no link of this file",
                   tree.joint_name(joint).c_str(), e.tag.c_str(), quoted(*link).c_str());
        (e.tag == "parent" ? parent_link : child_link)[joint] = found->second;
    }
    for (size_t j = 0; j < joints; j++)
        tree.attach(j, parent_link[j], child_link[j]);
    tree.check_root();
}
