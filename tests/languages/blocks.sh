# SPDX-License-Identifier: BSD-3-Clause
# For run.sh of each language: blocks of code of a page, to compile them in a frame of what they leave out.

# block PAGE KIND NUMBER: the block of that kind, from 1; nothing where there is none, which is a failure
block() {
    awk -v kind="\`\`\`$2" -v wanted="$3" '
        /^```/ { on = !on && $0 == kind && ++seen == wanted; next }
        on { print; said = 1 }
        END { exit !said }' "$1"
}
