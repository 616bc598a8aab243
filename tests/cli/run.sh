#!/usr/bin/env bash
# Runs one case of the command line's tests: run.sh FOLDER-OF-PROGRAMS CASE.sh
# The case runs in a fresh folder with the programs on its PATH; CASE.exit (0 when missing), CASE.stdout.glob and
# CASE.stderr.glob say what is expected. Inputs that a case makes go to in/: after a failure nothing else may be
# there, and whatever happens nothing may be left in TMPDIR. Status 77 of a case means that it was skipped.
set -u
programs=$(cd "$1" && pwd)
case=$2
here=$(cd "$(dirname "$0")" && pwd)
base=$here/$(basename "$case" .sh)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/run" "$work/run/in" "$work/tmp"

problem() {
    printf 'FAILED: %s\n--- stdout\n' "$*"
    head -c 2000 "$work/stdout" | tr -d '\0'
    printf -- '--- stderr\n'
    head -c 2000 "$work/stderr"
    exit 1
}

# matches FILE GLOB-FILE: the whole of one against the whole of the other
matches() {
    local text glob
    text=$(tr -d '\0' <"$1")
    glob=$(cat "$2")
    # shellcheck disable=SC2053
    [[ $text == $glob ]]
}

(
    cd "$work/run" || exit 99
    export PATH="$programs:$PATH" TMPDIR="$work/tmp" PYTHONPATH="$here" volumes="$(dirname "$(dirname "$here")")/volumes" PYTHONDONTWRITEBYTECODE=1 LC_ALL=C
    exec bash -eu "$base.sh"
) >"$work/stdout" 2>"$work/stderr" </dev/null
status=$?

[ $status -eq 77 ] && { cat "$work/stdout"; exit 77; }
expected=0
[ -f "$base.exit" ] && expected=$(cat "$base.exit")
[ "$status" -eq "$expected" ] || problem "status $status instead of $expected"
for stream in stdout stderr; do
    [ ! -f "$base.$stream.glob" ] || matches "$work/$stream" "$base.$stream.glob" ||
        problem "$stream is not $(cat "$base.$stream.glob")"
done
left=$(ls -A "$work/tmp")
[ -z "$left" ] || problem "left in TMPDIR: $left"
if [ "$expected" -ne 0 ]; then
    left=$(ls -A "$work/run" | grep -v '^in$')
    [ -z "$left" ] || problem "left behind: $left"
    [ "$(grep -c '' "$work/stderr")" -eq 1 ] || problem "not one line on stderr"
fi
exit 0
