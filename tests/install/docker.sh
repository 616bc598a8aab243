#!/usr/bin/env bash
# docker.sh [PACKAGES]: executes the Dockerfile without Docker: each stage in a Debian 12 of its own that has nothing, the lines of
# RUN and COPY as they stand there, on a clone of this repository. Then the command that the Dockerfile's head shows draws its
# picture by the ENTRYPOINT, and the picture of ./run demo has its pinned hash (tests/golden/demo.tsv). PACKAGES: a folder of .deb
# files, which are taken for what the first stage makes, instead of executing it (half an hour). Exit status 77, with a message:
# such a Debian cannot be had.
set -euo pipefail
packages=$([ $# -eq 0 ] || cd "$1" && pwd)
[ $# -gt 0 ] || packages=
scripts=$(cd "$(dirname "$0")" && pwd)

# begin_stage: a new $root; that of the stage before is kept in $built.
begin_stage() {
    if [ -n "${root:-}" ]; then
        umount "$root/proc" 2>/dev/null || true
        mv "$root" "$root-built"
    fi
    source "$scripts/chroot.sh"
    built=$root-built
    trap 'clean_up; rm -rf --one-file-system "$built"' EXIT
    workdir=/
}

# copy [--from=build] SOURCE ... TARGET
copy() {
    local from=$context skip=()
    if [[ $1 == --from=* ]]; then
        from=$built
        shift
    fi
    local sources=("${@:1:$#-1}") target=$root/${!#}
    mkdir -p "$target"
    for source in "${sources[@]}"; do
        if [ "$source" = . ]; then
            cp -r "$from/." "$target"
        elif [ "$from" = "$built" ] && [ -n "$packages" ]; then
            cp "$packages"/${source##*/} "$target"
        else
            cp -r "$from"/$source "$target"
        fi
    done
}

execute() {
    local instruction=$1 arguments=$2
    case $instruction in
    FROM)
        [[ $arguments =~ ^debian:12( AS [a-z]+)?$ ]] || fail "Dockerfile: FROM $arguments: debian:12 is known here"
        begin_stage
        stage=$((stage + 1))
        ;;
    RUN)
        [ "$stage" -gt 1 ] || [ -z "$packages" ] || return 0
        echo "docker.sh: RUN $arguments"
        local status=0
        in_root "cd $workdir && $arguments" </dev/null >build/docker.log 2>&1 || status=$?
        [ "$status" -eq 0 ] || { tail -n 40 build/docker.log; fail "RUN $arguments ended with $status"; }
        ;;
    COPY) copy $arguments ;;
    WORKDIR)
        workdir=$arguments
        mkdir -p "$root$workdir"
        ;;
    ENTRYPOINT) entrypoint=$(sed 's/[]["]//g; s/,/ /g' <<<"$arguments") ;;
    *) fail "Dockerfile: $instruction is not known here" ;;
    esac
}

cd "$scripts/../.."
mkdir -p build
context=$(mktemp -d)
git clone --quiet --no-hardlinks . "$context"
stage=0 entrypoint=
while read -r instruction arguments; do
    execute "$instruction" "$arguments"
done < <(sed -e ':join' -e '/\\$/ { N; s/\\\n *//; b join' -e '}' Dockerfile | grep -v '^#\|^$')
rm -rf "$context"
[ "$stage" -eq 2 ] && [ -n "$entrypoint" ] || fail "Dockerfile: two stages and an ENTRYPOINT are expected"

# What docker run does: this folder is /data.
shown=$(sed -n 's/^#.*docker run .* isopoint \(.*\)$/\1/p' Dockerfile)
[ -n "$shown" ] || fail "the head of the Dockerfile shows no docker run"
cp -r volumes "$root$workdir"
in_root "cd $workdir && $entrypoint $shown" </dev/null || fail "docker run .. $shown"
[ "$(head -c 8 "$root$workdir/stent.png" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || fail "stent.png is no PNG"
in_root "cd $workdir && $entrypoint volumes/stent.nrrd demo.png --isovalue 600 --samples 16 --azimuth 25 --elevation 10 \
    --crop 20,110,10,110,0,255 --quiet --json=demo.json" </dev/null || fail "the picture of ./run demo cannot be drawn"
found=$(sed -n 's/^ *"hash": *"\([0-9a-f]*\)".*/\1/p' "$root$workdir/demo.json" | head -n 1)
wanted=$(sed -n 's/\tstent$//p' tests/golden/demo.tsv)
[ "$found" = "$wanted" ] || fail "the picture of ./run demo has the hash $found, not $wanted"
[ ! -e "$root/packages" ] && [ -z "$(ls "$root/var/lib/apt/lists")" ] || fail "the image keeps what it was installed from"
echo "docker.sh: drew $shown and the picture of ./run demo, with its pinned hash ($(du -sm --one-file-system "$root" | cut -f1) MB)"
