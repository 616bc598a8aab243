#!/usr/bin/env bash
# bare.sh [COMMAND]: clones this repository into a Debian 12 that has nothing installed, and runs ./run COMMAND (demo if none
# is given) there, as a new user would. After demo, its pictures must be the pinned ones (tests/golden/demo.tsv), and build and
# install must not compile again what demo compiled, but for the sources that choose among the instruction sets of this build
# (src/base/kernel_units.h), whose units (tools/unity.cmake) hold nothing else. Exit status 77, with a message: such a Debian cannot
# be had.
set -euo pipefail
command=("${@:-demo}")
source "$(dirname "$0")/chroot.sh"

git clone --quiet --no-hardlinks . "$root/root/isopoint"
began=$SECONDS
in_root "cd /root/isopoint && ./run ${command[*]}" || fail "./run ${command[*]} ended with $? on a bare Debian"
echo "bare.sh: ./run ${command[*]} took $((SECONDS - began)) s"
[ "${command[*]}" = demo ] || exit 0

while IFS=$'\t' read -r hash picture; do
    found=$(sed -n 's/^ *"hash": *"\([0-9a-f]*\)".*/\1/p' "$root/root/isopoint/build/demo/$picture.json" | head -n 1)
    [ "$found" = "$hash" ] || fail "build/demo/$picture.png: its pixels have the hash $found, not $hash"
done < <(grep -v '^#' tests/golden/demo.tsv)
echo "bare.sh: the pictures are the pinned ones"
commands() { in_root "cd /root/isopoint && ninja -C build -t commands isorender isosculpt" | grep -- ' -c ' | sort; }
of_demo=$(commands)
in_root "cd /root/isopoint && cmake --preset release >/dev/null" || fail "another build cannot be configured"
again=$(comm -23 <(echo "$of_demo") <(commands))
[ -z "$again" ] || fail "another build would compile with other commands: $again"
# What changes with ISO_KERNELS alone is compiled again: the units of sources that choose among the instruction sets.
while read -r unit; do
    others=$(cd "$root" && sed -n 's/^#include "\/\(.*\)"$/\1/p' "root/isopoint/build/$unit" | xargs grep -L '"base/kernel_units.h"')
    [ -z "$others" ] || fail "another build would compile again: $others"
done < <(in_root "cd /root/isopoint && ninja -C build -t deps" |
    awk '/^[^ ]/ { object = $1 } /built_levels\.h$/ { sub(/\.o:$/, "", object); print object }' | grep /Unity/)
