# SPDX-License-Identifier: BSD-3-Clause
# Of table1.sh: from its times (NAME METHOD check|detection NS, in any order, a line a run) and crossings.csv, the tables
# as Markdown, and the files `table` and `figure`. `renderer` is what the z-buffer says that it was drawn by.

function digits(x) { return x >= 100 ? sprintf("%.0f", x) : sprintf("%.2g", x) }

# Checks a millisecond, and of detection alone in brackets; of the paper, as it has them.
function cell(scene, method,    check, detection) {
    check = least[scene, method, "check"]
    detection = least[scene, method, "detection"]
    if (!check)
        return "-"
    return digits(1e6 / check) (detection ? " (" digits(1e6 / detection) ")" : "")
}

# A row of a method here; into the table too.
function here(method,    i, line) {
    line = "| here: " titles[method] " |"
    for (i = 1; i <= 4; i++) {
        line = line " " cell(scenes[i], method) " |"
        if (least[scenes[i], method, "check"])
            print "here," scenes[i] ",\"" titles[method] "\"," per_ms(least[scenes[i], method, "check"]) "," \
                per_ms(most[scenes[i], method, "check"]) "," per_ms(least[scenes[i], method, "detection"]) "," \
                per_ms(most[scenes[i], method, "detection"]) >table
    }
    print line
}

function per_ms(ns) { return ns ? sprintf("%.4g", 1e6 / ns) : "" }

function paper(title, values,    i, of, parts) {
    split(values, of, "|")
    print "| paper: " title " | " of[1] " | " of[2] " | " of[3] " | " of[4] " |"
    for (i = 1; i <= 4; i++) {
        split(of[i], parts, /[ ()]+/)
        print "paper," scenes[i] ",\"" title "\"," parts[1] ",," parts[2] "," >table
    }
}

BEGIN {
    split("membrane cloth laparoscopy liver", scenes, " ")
    split("exact exact-contact exact-proxy paper-1 paper-2 paper-4 paper-8 paper-16 fcl ray z-buffer", methods, " ")
    drawn = renderer
    sub(/ .*/, "", drawn)
    titles["brute"] = "every triangle"
    titles["z-buffer"] = "z-buffer" (drawn ? " on " drawn : "")
    titles["z-buffer-2e-3"] = titles["z-buffer"] ", 512 pixels across the tool"
    titles["ray"] = "a ray, Embree"
    titles["fcl"] = "RSS trees, FCL"
    titles["exact"] = "exact, nearest pair"
    titles["exact-contact"] = "exact, contacts"
    titles["exact-proxy"] = "exact, proxy's force"
    titles["exact-force"] = "exact, the scene's force"
    titles["exact-physics"] = "exact, force and physics"
    for (i = 1; i <= 16; i *= 2)
        titles["paper-" i] = "dynamic point (" i ")"
}

FILENAME ~ /crossings.csv$/ {
    if (FNR > 1)
        verdict[++verdicts] = $0
    next
}

{
    key = $1 SUBSEP $2 SUBSEP $3
    if (!(key in least) || $4 < least[key])
        least[key] = $4
    if ($4 > most[key])
        most[key] = $4
    if (!($1 in known)) {
        known[$1] = 1
        names[++count] = $1
    }
}

END {
    print "source,scene,method,checks_per_ms,checks_least,detections_per_ms,detections_least" >table
    print "checks a millisecond (detection alone)\n"
    print "| | membrane 512 | cloth 2,048 | laparoscopy | liver, rigid |\n|---|---|---|---|---|"
    paper("Brute force", "1.5|0.5|0.12|0.018")
    here("brute")
    paper("Z-buffer", "0.22|0.26|0.22|0.015")
    here("z-buffer")
    here("ray")
    paper("PQP", "0.43 (3.6)|0.33 (2.8)|0.28 (2.5)|0.18 (0.8)")
    here("fcl")
    paper("Dynamic point (1)", "8.0 (37.0)|4.0 (36.0)|3.2 (8.6)|21.0 (26.0)")
    here("paper-1")
    paper("Dynamic point (2)", "5.2 (19.5)|2.4 (19.0)|2.0 (4.7)|12.5 (14.3)")
    here("paper-2")
    paper("Dynamic point (4)", "3.2 (8.7)|2.1 (9.0)|1.3 (2.4)|7.0 (8.1)")
    here("paper-4")
    paper("Dynamic point (8)", "1.9 (4.3)|1.8 (4.3)|0.65 (1.3)|3.7 (4.0)")
    here("paper-8")
    paper("Dynamic point (16)", "1.5 (2.2)|1.3 (2.1)|0.38 (0.63)|1.9 (2.1)")
    here("paper-16")
    here("exact")
    here("exact-contact")
    here("exact-force")
    here("exact-physics")
    for (key in least)
        if (split(key, part, SUBSEP) == 3 && most[key] > spread * least[key]) {
            spread = most[key] / least[key]
            where = part[1] ", " titles[part[2]]
        }
    printf "\nthe slowest of the runs takes up to %.0f %% longer than the fastest (%s)\n", 100 * (spread - 1), where
    print "the z-buffer is drawn by " (renderer ? renderer : "nothing: it is not here")

    print "mesh,triangles,moving,method,check,check_most,detection,detection_most" >figure
    print "\nms a check (detection alone)\n"
    for (n = 1; n <= count; n++) {
        name = names[n]
        if (name !~ /^[a-z]+-[0-9]/)
            continue
        split(name, part, "-")
        for (i = 1; i in methods; i++)
            if ((name, methods[i], "check") in least) {
                check = least[name, methods[i], "check"]
                detection = least[name, methods[i], "detection"]
                printf "%s,%d,%d,\"%s\",%.0f,%.0f,%s,%s\n", part[1] "-" part[2], part[2], name ~ /moving$/,
                    titles[methods[i]], check, most[name, methods[i], "check"], detection, most[name, methods[i], "detection"] >figure
                if (name ~ /^torus/)
                    printf "  %-20s %-36s %10.5f%s\n", name, titles[methods[i]], check / 1e6,
                        detection ? sprintf(" (%.5f)", detection / 1e6) : ""
            }
    }

    print "\ncrossings missed, invented, misnamed (0: none of them);"
    print "of methods that tell distances, % of the ticks with a wrong one\n"
    split("exact fcl paper-1 paper-16 ray z-buffer z-buffer-2e-3", order, " ")
    line = "| mesh | ticks | crossing |"
    rule = "|---|---|---|"
    for (i = 1; i <= 7; i++) {
        line = line " " titles[order[i]] " |"
        rule = rule "---|"
    }
    print line "\n" rule
    for (i = 1; i <= verdicts; i++) {
        split(verdict[i], v, ",")
        if (!(v[1] in ticks))
            meshes[++mesh_count] = v[1]
        if (v[4] > ticks[v[1]]) {
            ticks[v[1]] = v[4]
            crossing[v[1]] = v[5]
        }
        wrong = v[6] + v[7] + v[8] ? v[6] ", " v[7] ", " v[8] : "0"
        off = v[10] != "" ? sprintf("; %.2g %%", 100 * v[10] / v[4]) : ""
        judged[v[1], v[3]] = wrong off (v[4] < ticks[v[1]] ? " of " v[4] : "")
    }
    for (n = 1; n <= mesh_count; n++) {
        line = "| " meshes[n] " | " ticks[meshes[n]] " | " crossing[meshes[n]] " |"
        for (i = 1; i <= 7; i++)
            line = line " " ((meshes[n], order[i]) in judged ? judged[meshes[n], order[i]] : "-") " |"
        print line
    }
    print "\nthe z-buffer on the membrane by its pixel, a share of the tool's length\n"
    print "| pixel | missed | invented | misnamed |\n|---|---|---|---|"
    for (i = 1; i <= verdicts; i++) {
        split(verdict[i], v, ",")
        pixel = v[3] == "z-buffer" ? "1e-5" : substr(v[3], 10)
        if (v[1] == "membrane-512" && v[3] ~ /^z-buffer/)
            wrong_by[pixel] = pixel " | " v[6] " | " v[7] " | " v[8]
    }
    split("1e-5 1e-4 1e-3 2e-3 1e-2 1e-1 1", order, " ")
    for (i = 1; i in order; i++)
        if (order[i] in wrong_by)
            print "| " wrong_by[order[i]] " |"
}
