# SPDX-License-Identifier: BSD-3-Clause
# The tables of docs/measurements.md, as Markdown, from meshes.csv: median / 99 % in us, of each method on each mesh. What
# finds the nearest pair 5 % faster than `exact` at the median, or more, is bold, and its row says why. Of the tori the first
# and the last are shown.
BEGIN {
    why["paper in 1 part"] = "it asks a dozen neighbours, and is wrong on many ticks"
    why["cgal"] = why["embree"] = why["bullet"] = why["coal"] = "last tick's triangle is asked without a world"
    why["fcl"] = "a flat sheet lies in the plane of the pair, which rules nothing out"
}
NR == 1 {
    for (i = 1; i <= NF; i++) at[$i] = i
    next
}
{
    mesh = $1
    if (!(mesh in triangles)) {
        triangles[mesh] = $2
        if (mesh ~ /^torus/ && last ~ /^torus/ && tori++) meshes-- # the one before is no end
        order[++meshes] = last = mesh
    }
    row = $at["part"] "," $at["name"]
    if (!(row in seen)) {
        seen[row] = ++rows
        called[rows] = $at["name"] ($at["name"] == "exact" ? " (" $at["kernel"] ")" : "")
        part[rows] = $at["part"]
    }
    for (column in at) cell[seen[row], mesh, column] = $at[column]
}

function short(x) { return sprintf(x < 9.95 ? "%#.2g" : "%.0f", x) }

function head(title, more,   m, line) {
    print "\n" title "\n"
    line = "| |"
    for (m = 1; m <= meshes; m++) line = line " " order[m] (order[m] ~ /-/ ? "" : " " triangles[order[m]]) " |"
    gsub(/-/, " ", line)
    line = line more
    print line
    gsub(/[^|]+/, "---", line)
    print line
}

function table(which, kind, title,   r, m, c, line, text, exact, is_pair, is_faster) {
    if (!(which ",exact" in seen)) return
    is_pair = which == "pair"
    head(title, is_pair ? " why faster |" : "")
    for (r = 1; r <= rows; r++) {
        if (part[r] != which || called[r] ~ /brute|units|without|one step|[2-9] parts/) continue
        line = "| " called[r] " |"
        is_faster = 0
        for (m = 1; m <= meshes; m++) {
            c = cell[r, order[m], kind "median_us"]
            exact = cell[seen[which ",exact"], order[m], kind "median_us"]
            text = c == "" ? "" : short(c) " / " short(cell[r, order[m], kind "p99_us"])
            if (is_pair && c != "" && c < 0.95 * exact) {
                text = "**" text "**"
                is_faster = 1
            }
            line = line " " text " |"
        }
        print line (is_pair ? (is_faster ? " " why[called[r]] : "") " |" : "")
    }
}

# What the paper's method gets wrong, and its median.
function papers(   r, m, c, line) {
    head("The paper's method, all ticks: wrong ticks, largest error, median in us:")
    for (r = 1; r <= rows; r++) {
        if (part[r] != "pair" || called[r] !~ /^paper/) continue
        line = "| " called[r] " |"
        for (m = 1; m <= meshes; m++) {
            c = cell[r, order[m], "wrong"]
            line = line " " (c ? short(100 * c / cell[r, order[m], "ticks"]) " %, " \
                short(1000 * cell[r, order[m], "distance_error_m"]) " mm" : 0) ", " short(cell[r, order[m], "median_us"]) " |"
        }
        print line
    }
}

END {
    table("pair", "other_", "Nearest pair, ticks that do not cross:")
    table("pair", "crossing_", "Nearest pair, ticks that cross:")
    table("pair", "", "Nearest pair, all ticks:")
    papers()
    table("contact", "other_", "Contact, ticks that do not cross:")
    table("contact", "crossing_", "Contact, ticks that cross:")
}
