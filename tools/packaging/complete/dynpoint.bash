# SPDX-License-Identifier: BSD-3-Clause
# Completion for bash: the program itself knows what may follow. Installed as bash-completion/completions/dynpoint.

_dynpoint() {
    local line=${COMP_LINE:0:COMP_POINT} words word typed found
    read -r -a words <<<"$line"
    [[ $line != *[[:space:]] ]] || words+=("")
    word=${words[${#words[@]} - 1]}
    # Bash replaces what follows the last '=' or ':' alone.
    typed=${word%"${word##*[=:]}"}
    COMPREPLY=()
    while IFS= read -r found; do
        if [[ $found == :files ]]; then
            compopt -o filenames 2>/dev/null
            while IFS= read -r found; do
                COMPREPLY+=("$found")
            done < <(compgen -f -- "${word#--*=}")
        else
            COMPREPLY+=("${found#"$typed"}")
        fi
    done < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
}
complete -F _dynpoint dynpoint
