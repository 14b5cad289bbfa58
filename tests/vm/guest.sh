#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# In the guest: runs the commands of the file $job, one a line, each for $limit seconds at most.
cd "$repository" || exit
while IFS= read -r command; do
    echo "vm: run $command"
    timeout -k 5 "$limit" sh -c "$command" </dev/null
    echo "vm: status $? of $command"
done <"$job"
echo "vm: end"
