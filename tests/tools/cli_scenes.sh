#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# dynpoint run: the scenes by name are felt, recorded and replayed. `sh tests/tools/cli_scenes.sh BUILD [part]`.
. "$(dirname "$0")/cli.sh"

scenes='membrane cloth laparoscopy liver soft-liver needle biopsy tori'
[ ! "$is_part" ] || scenes='liver membrane'
for scene in $scenes; do
    succeeds "run $scene" run $scene --device 'sim:?hand=press' --for 2 --record $scene.dpr --json
    check "$scene is touched: $(cat stdout)" grep -q '"contacts":[1-9][0-9]\{2\}' stdout
    check "$scene: nothing is unknown" grep -q '"unknown":0,' stdout
    succeeds "replay $scene" replay $scene.dpr
    check "$scene: other bits: $(cat stdout)" grep -q ': 2000 ticks, all the same bits$' stdout
done
run replay liver.dpr membrane
check "a replay with another scene: exit $status" test $status -eq 2
check "is told: $(cat stderr)" grep -q 'membrane: this is another scene than the recording' stderr
refuses 'a scene that is not there' 'livre: there is no scene of this name, and no such file' run livre --device sim --ticks 5
finish
