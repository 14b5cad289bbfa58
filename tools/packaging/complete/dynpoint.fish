# SPDX-License-Identifier: BSD-3-Clause
# Completion for fish: the program itself knows what may follow. Installed as fish/vendor_completions.d/dynpoint.fish.

function __dynpoint_complete
    set -l words (commandline -opc) (commandline -ct)
    for found in ($words[1] complete $words[2..-1] 2>/dev/null)
        if test "$found" = :files
            __fish_complete_path (commandline -ct)
        else
            echo $found
        end
    end
end
complete -c dynpoint -f -a '(__dynpoint_complete)'
