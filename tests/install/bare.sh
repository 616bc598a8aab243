#!/usr/bin/env bash
# bare.sh [COMMAND]: clones this repository into a Debian 12 that has nothing installed, and runs ./run COMMAND (demo if none
# is given) there, as a new user would. After demo, its pictures must be the pinned ones (tests/golden/demo.tsv), and build and
# install must not compile again what demo compiled, but for the sources that choose among the instruction sets of this build
# (src/base/kernel_units.h), whose units (tools/unity.cmake) hold nothing else. What was downloaded for Debian itself is kept in build/bare.tar.
# Exit status 77, with a message: debootstrap or chroot cannot be had.
set -euo pipefail
cd "$(dirname "$0")/../.."
command=("${@:-demo}")

skip() {
    echo "skipped: $*"
    exit 77
}
fail() {
    echo "FAILED: $*"
    exit 1
}

[ "$(id -u)" -eq 0 ] || skip "a bare Debian needs root, for chroot"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 2>/dev/null | awk '$2 == "bookworm" { print $1; exit }')
[ -n "$mirror" ] || skip "apt names no mirror of Debian 12"

mkdir -p build
root=$PWD/build/bare
in_root() { chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin bash -c "$1"; }
clean_up() {
    umount "$root/proc" 2>/dev/null || true
    rm -rf --one-file-system "$root"
}
trap clean_up EXIT
clean_up
mkdir -p "$root"
if [ ! -e build/bare.tar ]; then
    debootstrap --variant=minbase bookworm "$root" "$mirror" >build/bare.log 2>&1 || skip "debootstrap: $(tail -n 1 build/bare.log)"
    tar -C "$root" -cf build/bare.tar.new .
    mv build/bare.tar.new build/bare.tar
else
    tar -C "$root" -xf build/bare.tar
fi
in_root true 2>/dev/null || skip "chroot does not work here"
# apt's own settings are the machine's: mirrors, their keys, proxies.
rm -f "$root/etc/apt/sources.list"
cp -r /etc/apt/sources.list* /etc/apt/apt.conf.d /etc/apt/trusted.gpg.d "$root/etc/apt/"
rm -f "$root"/etc/apt/apt.conf.d/{20packagekit,50appstream,docker-clean}
echo 'Dpkg::Use-Pty "0";' >"$root/etc/apt/apt.conf.d/99bare"
[ ! -e /etc/resolv.conf ] || cp /etc/resolv.conf "$root/etc/"
mount -t proc proc "$root/proc" 2>/dev/null || echo "bare.sh: no /proc in the chroot"

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
