#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
#
# All public declarations as plain C, for foreign-function interfaces (docs/ffi.md):
#
#     sh tools/packaging/cdef.sh INCLUDE OUT LIBRARY=FOLDER,FOLDER... LIBRARY=...
#
# INCLUDE holds dynpoint.h and dynpoint/*.h. A header belongs to the library whose folders define what it declares; one
# that declares no function, to that of the header that follows it. The preprocessor (CC, or cc) takes out conditionals,
# attributes and macros; functions that are inline in a header are left out, as a library exports what they call.
set -eu
LC_ALL=C
export LC_ALL
include=$1 out=$2
shift 2
scratch=$out.d
rm -rf "$scratch"
mkdir -p "$scratch/std"

# Which library defines what.
for entry; do
    for folder in $(echo "${entry#*=}" | tr , ' '); do
        find "$folder" -name '*.c' -o -name '*.cc'
    done | while read -r source; do
        sed -n "s/^[a-z].*[ *]\(dpt_[a-z0-9_]*\)(.*/${entry%%=*} \1/p" "$source"
    done
done >"$scratch/defined"

# No system header is read: nothing but names of types and one constant is used of them.
: >"$scratch/std/stddef.h"
echo '#define UINT32_MAX 4294967295' >"$scratch/std/stdint.h"
{
    echo '#include "dynpoint.h"'
    for header in "$include"/dynpoint/*.h; do
        echo "#include \"dynpoint/$(basename "$header")\""
    done
    for header in "$include"/dynpoint/*.h; do
        sed -n "s/^# *define \(DPT_[A-Z0-9_]*\) .*/@ $(basename "$header") \"\1\" \1/p" "$header"
    done
} >"$scratch/all.c"
${CC:-cc} -E -nostdinc -U__GNUC__ -I"$scratch/std" -I"$include" "$scratch/all.c" >"$scratch/all.i"

awk -v libraries="$(for entry; do echo "${entry%%=*}"; done)" -v version="$(
    sed -n 's/^#define DPT_VERSION_STRING "\(.*\)"/\1/p' "$include/dynpoint/base.h")" '
function keep_macro(header, name, value) {
    gsub(/^[ (]+|[ )]+$/, "", value)
    if (value ~ /^[-+]?(0[xX][0-9a-fA-F]+|[0-9]+)[uUlL]*$/) {
        sub(/[uUlL]+$/, "", value)
        macros[header] = macros[header] "static const " (value ~ /^-/ ? "int32_t " : "uint32_t ") name " = " value ";\n"
    } else if (value ~ /^([-+]?[0-9.][-+0-9a-zA-Z.]*|".*")$/)
        macros[header] = macros[header] "/* " name " is " value " */\n"
}
# A struct or an enum has a line for each member.
function laid_out(text,   depth, inside, i, c, result) {
    if (text !~ /\{/)
        return text
    for (i = 1; i <= length(text); i++) {
        c = substr(text, i, 1)
        if (c == "(") depth++
        if (c == ")") depth--
        if (c == "}") { sub(/[ \n]+$/, "", result); result = result "\n" c; inside = 0; continue }
        result = result c
        if (c == "{") inside = 1
        if (inside && (c == "{" || c == ";" || (c == "," && !depth && text ~ /^(typedef )?enum/))) {
            result = result "\n    "
            while (substr(text, i + 1, 1) == " ") i++
        }
    }
    return result
}
function keep_item(text) {
    gsub(/[ \t]+/, " ", text); gsub(/^ | $/, "", text); gsub(/ ;/, ";", text); gsub(/\( /, "(", text); gsub(/ \)/, ")", text)
    if (text ~ /^static/ || text == ";")
        return
    if (text ~ /^[^{]*\(/ && text !~ /^typedef/ && match(text, /dpt_[a-z0-9_]+ ?\(/)) {
        name = substr(text, RSTART, RLENGTH); sub(/ ?\(/, "", name)
        if (!(name in library)) {
            print "cdef: " file " declares " name ", which no library defines" >"/dev/stderr"
            exit failed = 1
        }
        if (file in belongs && belongs[file] != library[name]) {
            print "cdef: " file " declares functions of " belongs[file] " and of " library[name] >"/dev/stderr"
            exit failed = 1
        }
        belongs[file] = library[name]
    }
    items[file] = items[file] laid_out(text) "\n"
}
NR == FNR { library[$2] = $1; next }
# A header comes where it ends, so behind those that it includes.
$1 == "#" {
    if ($4 == 2 && !(file in seen)) { seen[file] = 1; order[++files] = file }
    file = $3; gsub(/^"|"$/, "", file); sub(/.*\//, "", file)
    next
}
$1 == "@" { name = $3; gsub(/"/, "", name); header = $2; $1 = $2 = $3 = ""; keep_macro(header, name, $0); next }
{
    for (i = 1; i <= length($0); i++) {
        c = substr($0, i, 1)
        text = text c
        if (c == "{") depth++
        if (c == "}") depth--
        if (!depth && (c == ";" || (c == "}" && text ~ /^ *static/))) { keep_item(text); text = "" }
    }
    text = text " "
}
END {
    if (failed) exit 1
    for (i = files; i > 0; i--) {
        if (!(order[i] in belongs)) belongs[order[i]] = next_one
        next_one = belongs[order[i]]
    }
    print "/* SPDX-License-Identifier: BSD-3-Clause */"
    print "/*"
    print " * dynpoint " version ": all that the libraries export, as plain C without a preprocessor, for"
    print " * foreign-function interfaces. Made from the headers, which say what it means. A library needs its own section"
    print " * and those before it."
    print " */"
    count = split(libraries, list, /[ \n]+/)
    for (l = 1; l <= count; l++) {
        print "\n/* ==== " list[l] " ==== */"
        for (i = 1; i <= files; i++)
            if (belongs[order[i]] == list[l] && (macros[order[i]] items[order[i]]) != "")
                printf "\n/* %s */\n%s%s", order[i], macros[order[i]], items[order[i]]
    }
}' "$scratch/defined" "$scratch/all.i" >"$scratch/out"
mv "$scratch/out" "$out"
rm -rf "$scratch"
