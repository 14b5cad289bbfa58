/* SPDX-License-Identifier: BSD-3-Clause */
#include <cstdio>
#include <cstring>

#include "urdf/urdf_scene.h"

namespace
{

bool begins_with(const std::string &text, const char *prefix)
{
    return text.compare(0, std::strlen(prefix), prefix) == 0;
}

bool file_exists(const std::string &path)
{
    std::FILE *file = std::fopen(path.c_str(), "rb");
    if (file)
        std::fclose(file);
    return file;
}

/* The folder of a path: it ends in '/', or is empty. */
std::string folder_of(const std::string &path)
{
    return path.substr(0, path.rfind('/') + 1);
}

int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Decode the %XX of an address: %20 is a space. */
std::string percent_decoded(const std::string &text, size_t line, const std::string &owner)
{
    std::string result;
    for (size_t i = 0; i < text.size(); i++) {
        if (text[i] != '%') {
            result += text[i];
            continue;
        }
        int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1,
            low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
        if (high < 0 || low < 0 || 16 * high + low < 0x20)
            refuse_path(DPT_E_SYNTAX, line, owner, text,
                        ": '%' is not followed by two digits of a character");
        result += static_cast<char>(16 * high + low);
        i += 2;
    }
    return result;
}

/* The length of the folder at `at` up to the next ':', if it begins with a drive (C:/ros); else 0. */
size_t drive_length(const char *at)
{
    const bool has_letter = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z');
    return has_letter && at[1] == ':' && (at[2] == '/' || at[2] == '\\')
               ? 2 + std::strcspn(at + 2, ":")
               : 0;
}

/* The path of package://REST. REST is NAME/..., `packages` as in dpt_urdf_def, `file` the URDF. */
std::string path_in_package(const std::string &rest, const std::string &file, const char *packages,
                            size_t line, const std::string &owner)
{
    size_t slash = rest.find('/');
    std::string name = rest.substr(0, slash);
    if (slash == std::string::npos || name.empty() || name == "." || name == "..")
        refuse_path(DPT_E_SYNTAX, line, owner, "package://" + rest, " names no package and file");
    for (const char *at = packages; at && *at;) {
        size_t length = std::strcspn(at, ":"), drive = drive_length(at);
        for (size_t count : { drive, length }) {
            std::string folder(at, count);
            if (count && file_exists(folder + "/" + rest))
                return folder + "/" + rest;
        }
        at += length + (at[length] == ':');
    }
    /* "./" comes first, so that "../" can follow a name without a folder. */
    std::string folder = folder_of(file);
    if (!begins_with(folder, "/"))
        folder = "./" + folder;
    for (size_t up = 0; up < 32; up++) {
        if (file_exists(folder + rest))
            return folder + rest;
        folder += "../";
    }
    return folder_of(file) + rest.substr(slash + 1);
}

} // namespace

std::string mesh_path(const std::string &name, const std::string &file, const char *packages,
                      size_t line, const std::string &owner)
{
    if (name.empty())
        refuse(DPT_E_SYNTAX, line, "%s: a mesh without a file's name", owner.c_str());
    if (begins_with(name, "package://"))
        return path_in_package(percent_decoded(name.substr(10), line, owner), file, packages, line,
                               owner);
    if (begins_with(name, "file:///"))
        return percent_decoded(name.substr(7), line, owner);
    if (begins_with(name, "file://localhost/"))
        return percent_decoded(name.substr(16), line, owner);
    if (name.find("://") != std::string::npos)
        refuse_path(DPT_E_UNSUPPORTED, line, owner, name,
                    ": only package://NAME/..., file:///... and plain names are taken");
    return name[0] == '/' ? name : folder_of(file) + name;
}
