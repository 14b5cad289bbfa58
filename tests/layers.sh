#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Who uses whom: `sh tests/layers.sh BUILD [ROOT]`. A folder of the core uses itself and those before it in the
# Makefile's FOLDERS, what lies around the core uses its public symbols; includes say so in the sources, nm says so of the
# objects below BUILD. ROOT is the tree to look at, this one if not given (tests/layers_test.sh breaks a copy).
set -u
. "$(dirname "$0")/lib/verdict.sh"
build=$1
case $build in /*) ;; *) build=$PWD/$build ;; esac
cd "${2:-.}" || exit 2
scratch=$build/layers
rm -rf "$scratch"
mkdir -p "$scratch"
LC_ALL=C
export LC_ALL

# report RULE WHAT: each finding of the rule fails; without one, WHAT is so.
report() {
    sed -n "s/^$1: //p" "$scratch/findings" >"$scratch/$1"
    while read -r finding; do bad "$finding"; done <"$scratch/$1"
    [ -s "$scratch/$1" ] || ok "$2"
}

folders=$(sed -n 's/^FOLDERS := //p' Makefile)
find include src drivers tools -name '.?*' -prune -o -name __pycache__ -prune -o -type f -print | sort >"$scratch/files"
grep -E '\.(c|cc|h)$' "$scratch/files" >"$scratch/sources"
(cd "$build" && find src drivers tools -name '*.o') 2>/dev/null | sort >"$scratch/built"
if [ -z "$folders" ] || [ ! -s "$scratch/sources" ] || [ ! -s "$scratch/built" ]; then
    bad "no FOLDERS in the Makefile, no sources, or no objects below $build: run make first"
    finish
fi

# The rules. may(user, used): 2 if headers and all symbols, 1 if public symbols and inline headers, 0 if nothing.
rules='
function is_in(word, list) { return index(" " list " ", " " word " ") > 0 }
function set_rules(folders, count, i)
{
    count = split(folders, core, " ")
    for (i = 1; i <= count; i++) rank[core[i]] = i
    # Narrower than the order of FOLDERS.
    only["force"] = "base"
    only["exchange"] = "base"
    only["arm"] = "base mesh"
    apart = "sweep contact strip"
    # Around the core: whose internal headers and symbols are used too, and whose public symbols only; "core" is all of it.
    inner["text"] = "";                    public["text"] = "base"
    inner["compile"] = "text";             public["compile"] = "core"
    inner["urdf"] = "text";                public["urdf"] = "core compile"
    inner["convex"] = "";                  public["convex"] = "core"
    inner["bindings"] = "tools scene drivers"; public["bindings"] = "core compile urdf convex host"
    inner["drivers"] = "text";             public["drivers"] = "core"
    inner["scene"] = "text drivers";       public["scene"] = "core compile convex"
    inner["host"] = "text scene drivers";  public["host"] = "core"
    inner["tools"] = "text compile drivers scene host"; public["tools"] = "core urdf convex"
    never["drivers"] = "mesh"
    # What the host library does, tools do not do once more.
    once["tools"] = "dpt_world_create dpt_passivity_init dpt_passivity_step dpt_coupling_for_device"
    inner["include"] = "";                 public["include"] = ""
    # Headers of the core that the others may include, if they are wholly static inline.
    inline_headers = "^src/(base/[^/]*|mesh/[^/]*|nearest/segment_triangle|arm/arm_format|exchange/latest_value)[.]h$"
}
function may(user, used)
{
    if (user == used || used == "include") return 2
    if (user in rank) {
        if (!(used in rank) || rank[used] > rank[user]) return 0
        if (user in only) return is_in(used, only[user]) ? 2 : 0
        return is_in(user, apart) && is_in(used, apart) ? 0 : 2
    }
    if (is_in(used, inner[user])) return 2
    if (is_in(used, never[user])) return 0
    return is_in(used, public[user]) || (used in rank && is_in("core", public[user])) ? 1 : 0
}
# The folder that a file counts to: of src/ its own, else the first of its path.
function unit_of(path, part) { return split(path, part, "/") > 2 && part[1] == "src" ? part[2] : part[1] }
function is_known(unit) { return unit in rank || unit in inner }
function basename_of(path) { sub(/.*\//, "", path); return path }
function folder_of(path) { sub(/\/[^\/]*$/, "", path); return path }
function find(rule, sentence) { print rule ": " sentence }
'

generated=
[ ! -e "$build/built_with.h" ] || generated=built_with.h
awk -v folders="$folders" -v generated="$generated" "$rules"'
# What a header declares that is not static: a name, or "" if all is inline.
function not_inline(path, line, text, depth, i, c, statement, skipping, name)
{
    if (path in declared) return declared[path]
    depth = skipping = 0
    statement = text = ""
    while ((getline line <path) > 0) {
        if (skipping || line ~ /^[ \t]*#/) skipping = line ~ /\\$/
        else text = text " " line
    }
    close(path)
    gsub(/"[^"]*"/, "\"\"", text)
    gsub(/\047[{}();]\047/, "0", text)
    gsub(/__attribute__ *[(][(][^;{]*[)][)]/, "", text)
    while (i = index(text, "/*")) {
        c = index(substr(text, i + 2), "*/")
        if (!c) break
        text = substr(text, 1, i - 1) " " substr(text, i + c + 3)
    }
    name = ""
    while (name == "" && match(text, /[{};]/)) {
        c = substr(text, RSTART, 1)
        if (depth == 0) statement = statement substr(text, 1, RSTART - 1)
        text = substr(text, RSTART + 1)
        sub(/^[ \t]+/, "", statement)
        if (c == "{" && depth == 0 && statement ~ /^extern ""/) {
            statement = ""
            continue
        }
        if (depth == 0 && (c == ";" || c == "{") && statement !~ /^(static|typedef|_Static_assert)[ (]/ &&
            (statement ~ /[(]/ || statement ~ /^extern /)) {
            name = statement
            sub(/ *[(\[].*/, "", name)
            sub(/.*[ *]/, "", name)
        }
        if (c == "{") depth++
        if (c == "}" && depth > 0) depth--
        if (depth == 0 && (c == ";" || (c == "}" && statement ~ /[(]/))) statement = ""
    }
    declared[path] = name
    return name
}
# Where an include is found, or "" with the finding already told.
function resolve(file, name, quoted, place, folder)
{
    folder = folder_of(file)
    if (name ~ /(^|\/)[.][.]?\//) {
        find("root", file " includes " name ": a path begins at a root, without ./ or ../")
        return ""
    }
    if (folder == "drivers/serial" && name ~ /^wire(_device)?[.]h$/ && (place = folder "/" name) in exists) return place
    if (file ~ /^src\/(scene|host)\// && (place = "drivers/" name) in exists) return place
    if (!(file ~ /^src\// && name !~ /\//)) {
        if ((place = "include/" name) in exists) return place
        if (file !~ /^include\// && (place = "src/" name) in exists) return place
        if (file ~ /^(drivers|tools|src\/bindings)\// && (place = "drivers/" name) in exists) return place
        if (file ~ /^(tools|src\/bindings)\// && (place = "tools/" name) in exists) return place
    }
    if (!quoted || (file ~ /^(drivers|tools|src\/scene)\// && name == generated)) return ""
    if ((place = folder "/" name) in exists) {
        sub(/^[a-z]*\//, "", place)
        find("root", file " includes " name ": write " place)
    } else if (name !~ /\// && ("include/" name) in exists) {
        find("root", file " includes " name ": src includes what it needs, dynpoint/...")
    } else find("root", file " includes " name ": there is no such file")
    return ""
}
function look(file, unit, name, quoted, place, used, level, culprit)
{
    place = resolve(file, name, quoted)
    if (place == "") return
    used = unit_of(place)
    if (!is_known(used)) return
    # The one part of the public headers that a rule knows.
    if (is_in("mesh", never[unit]) && place == "include/dynpoint/mesh.h") used = "mesh"
    level = may(unit, used)
    if (level == 0) find("include", file " includes " name ": " unit " may not use " used)
    if (level != 1) return
    if (place !~ inline_headers)
        find("include", file " includes " name ": " unit " may use " used " by public symbols only")
    else if ((culprit = not_inline(place)) != "")
        find("include", file " includes " name ", which declares " culprit ": " unit " may include inline headers only")
}
{
    file[NR] = $0
    exists[$0] = 1
    held[folder_of($0)]++
    name = basename_of($0)
    if (name ~ /^(README[.]md|package[.]json|Cargo[.]toml|lib[.]rs)$/) next # so named by those who read them
    if (name in first) find("name", first[name] " and " $0 ": a file name occurs once")
    else first[name] = $0
}
END {
    set_rules(folders)
    for (word in only) if (!(word in rank)) find("folder", "the rules name " word ", FOLDERS does not")
    split(apart, words, " ")
    for (i in words) if (!(words[i] in rank)) find("folder", "the rules name " words[i] ", FOLDERS does not")
    for (i = 1; i <= NR; i++) {
        unit = unit_of(file[i])
        if (file[i] ~ /^src\/[^\/]*\// && !is_known(unit) && !told[unit]++)
            find("folder", "src/" unit " is neither in FOLDERS nor among those around the core")
        if (file[i] !~ /[.](c|cc|h)$/) continue
        if (file[i] ~ /^src\/[^\/]*$/) find("folder", file[i] " lies in no folder")
        lines = 0
        while ((getline line <file[i]) > 0) {
            lines++
            if (line !~ /^[ \t]*#[ \t]*include[^_a-zA-Z0-9]/ || !is_known(unit)) continue
            sub(/^[ \t]*#[ \t]*include[ \t]*/, "", line)
            if (line !~ /^("[^"]*"|<[^>]*>)/) {
                find("root", file[i] " includes " line ": a name that only the compiler knows")
                continue
            }
            quoted = line ~ /^"/
            line = substr(line, 2)
            sub(/[">].*/, "", line)
            look(file[i], unit, line, quoted)
        }
        close(file[i])
        if (lines > 600) find("long", file[i] " has " lines " lines: 600 at most")
        if (file[i] ~ /[.](c|cc)$/) {
            for (at = ++sources; at > 1 && length_of[at - 1] > lines; at--) length_of[at] = length_of[at - 1]
            length_of[at] = lines
        }
    }
    if (length_of[int((sources + 1) / 2)] <= 250)
        find("crumbs", "half of the " sources " sources have at most 250 lines: they are crumbs")
    for (folder in held)
        if (held[folder] > (folder == "tools" ? 4 : 44))
            find("full", folder " holds " held[folder] " files: " (folder == "tools" ? 4 : 44) " at most")
}' "$scratch/files" >"$scratch/findings" || exit 2

# Objects of sources that are here; others are left over. What the machine or the user left out is not looked at.
awk -v folders="$folders" "$rules"'
BEGIN { set_rules(folders) }
FILENAME == ARGV[1] {
    sub(/[.]o$/, "")
    built[$0] = 1
    folder[folder_of($0)] = 1
    next
}
/[.](c|cc)$/ && is_known(unit_of($0)) {
    source = $0
    sub(/[.](c|cc)$/, "")
    if ($0 in built) find("see", $0 ".o")
    else if ($0 ~ /^src\/bindings\//) next # for another machine, or where `make wheel` was called (tests/wasm, tests/python)
    else if ($0 ~ /^drivers\/platform\//) next    # for another system (tests/platforms)
    else if ($0 ~ /^(src\/scene\/(json_|scene_file)|tools\/plan\/plan_file_parse)/) {
        if (!told["json"]++) find("skip", "what reads scene files is not built: nothing says what it calls")
    } else if (folder_of($0) in folder || $0 !~ /^(src\/(urdf|convex|bindings)|drivers\/[^\/]*|tools\/view\/server)\//)
        find("object", source " has no object: nothing says what it calls")
    else if (!told[folder_of($0)]++) find("skip", folder_of($0) " is not built: nothing says what it calls")
}' "$scratch/built" "$scratch/sources" >"$scratch/objects" || exit 2
grep '^object: ' "$scratch/objects" >>"$scratch/findings"
sed -n 's/^see: //p' "$scratch/objects" >"$scratch/see"
(cd "$build" && xargs "${NM:-nm}" -A -P -g <"$scratch/see") >"$scratch/nm"
status=$?
[ "$status" -eq 0 ] && [ -s "$scratch/nm" ] || bad "nm left status $status"

awk -v folders="$folders" "$rules"'
BEGIN { set_rules(folders) }
{ object = $1; sub(/:$/, "", object) }
$3 ~ /^[Uwv]$/ { user[++uses] = object; wanted[uses] = $2; next }
# C++ puts the same into several objects: the first counts.
$3 ~ /^[WVu]$/ { if (!($2 in shared)) shared[$2] = object; next }
{ definer[$2] = object }
END {
    for (name in shared) if (!(name in definer)) definer[name] = shared[name]
    for (i = 1; i <= uses; i++) {
        if (!(wanted[i] in definer)) continue
        object = user[i]
        place = definer[wanted[i]]
        unit = unit_of(object)
        used = unit_of(place)
        level = may(unit, used)
        call = object " calls " wanted[i] " of " place
        if (is_in(wanted[i], once[unit])) find("call", call ": " unit " leave that to src/scene and src/host")
        if (level == 0) find("call", call ": " unit " may not use " used)
        else if (level == 1 && wanted[i] !~ /^dpt_/) find("call", call ": " unit " may use " used " by public symbols only")
        if (unit == used && unit in rank && object != place) {
            edge = object SUBSEP place
            if (!(edge in names)) edges[++edge_count] = edge
            names[edge] = names[edge] " " wanted[i]
            reaches[object, place] = 1
            node[object] = node[place] = 1
        }
    }
    # Who reaches whom inside a folder; a call lies on a circle if what is called reaches the caller.
    for (through in node) for (from in node) {
        if (!((from, through) in reaches)) continue
        for (to in node) if ((through, to) in reaches) reaches[from, to] = 1
    }
    for (i = 1; i <= edge_count; i++) {
        split(edges[i], ends, SUBSEP)
        if (!((ends[2], ends[1]) in reaches)) continue
        for (at = 1; at <= circles; at++) if ((ends[1], member[at]) in reaches && (member[at], ends[1]) in reaches) break
        if (at > circles) member[++circles] = ends[1]
        said[at] = said[at] (said[at] == "" ? "" : ", ") basename_of(ends[1]) " calls" names[edges[i]] " of " basename_of(ends[2])
    }
    for (at = 1; at <= circles; at++) find("circle", "a circle in " folder_of(member[at]) ": " said[at])
}' "$scratch/nm" >>"$scratch/findings" || exit 2

# Paths that pages and file comments name. NAME stands for any; what an include begins with is the include rule's.
for page in README.md docs include src drivers tools tests; do [ ! -e $page ] || echo $page; done >"$scratch/places"
grep -rnoE '(^|[^A-Za-z0-9_./-])((\.\./)*)(src|drivers|tools|tests|include)/[A-Za-z0-9_./-]*\.(c|h|cc|cpp|sh|py|md|mk|txt)\b' \
    --include='*.md' --include='*.[ch]' --include='*.cc' --include='*.mk' $(cat "$scratch/places") 2>/dev/null |
    grep -vE '[^:]*:[0-9]*:"|NAME|include/HD/' | sed -E 's/^([^:]*:[0-9]*):[^A-Za-z.]?(\.\.\/)*/\1 /' |
    while read -r where path; do
        [ -e "$path" ] || echo "path: $where names $path, which is not there"
    done >>"$scratch/findings"

report folder "each folder of src/ has its place: $folders, and those around them"
report root "each include begins at a root, and is there"
report include "each includes only what it may use"
report name "a file name occurs once"
report path "each path that a page or a comment names is there"
report long "no source is longer than 600 lines"
report crumbs "half of the sources are longer than 250 lines"
report full "no folder holds more than 44 files, and in tools/ itself lie 4 at most"
report object "each source has its object"
report call "each calls only what it may use"
report circle "inside a folder of the core, no files call each other in a circle"
sed -n 's/^skip: //p' "$scratch/objects" >"$scratch/skips"
while read -r what; do skip "$what"; done <"$scratch/skips"

finish
