#!/usr/bin/env bash
# Runs one case of the command line's tests: run.sh FOLDER-OF-PROGRAMS CASE.sh, or a line of refusals.tsv by its name:
# run.sh FOLDER-OF-PROGRAMS NAME
# The case runs in a fresh folder with the programs on its PATH. Its first lines may say what is expected of it:
#     # exit: 2                 the exit status, 0 when not said
#     # stdout: GLOB            a bash pattern for the whole of standard output
#     # stderr: GLOB            the same for standard error
# Inputs that a case makes go to in/. A case that is expected to fail must leave no other file and write one line to standard
# error; no case may leave anything in TMPDIR. Exit status 77 of a case means that it was skipped. Cases can call the function
# `refuses`, below.
set -u
programs=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/run" "$work/run/in" "$work/tmp"
if [[ $2 == *.sh ]]; then
    case=$(realpath "$2")
else
    case=$work/$2.sh
    awk -F'\t' -v name="$2" '$1 == name { printf "# exit: %s\n# stderr: %s\n%s\n", $2, $3, $4 }' "$here/refusals.tsv" >"$case"
    [ -s "$case" ] || { echo "FAILED: refusals.tsv has no $2"; exit 1; }
fi

problem() {
    printf 'FAILED: %s\n--- stdout\n' "$*"
    head -c 2000 "$work/stdout" | tr -d '\0'
    printf -- '--- stderr\n'
    head -c 2000 "$work/stderr"
    exit 1
}

# read_expectations: fills `expected` from the first lines of the case. A line that only looks like an expectation
# (misspelt, given twice, below other lines) would silently not be checked, so it fails the test.
declare -A expected
read_expectations() {
    local line at_top=1
    local right='^# (exit|stdout|stderr): ([^[:space:]].*)$'
    local similar='^#[[:space:]]*(exit|stdout|stderr)([^[:alpha:]]|$)' other_word='^#[[:space:]]*[[:alpha:]]+[[:space:]]*:'
    while IFS= read -r line || [[ $line ]]; do
        if [[ $at_top && $line =~ $right && ! -v expected[${BASH_REMATCH[1]}] ]]; then
            expected[${BASH_REMATCH[1]}]=${BASH_REMATCH[2]}
        elif [[ $line =~ $similar || ($at_top && $line =~ $other_word) ]]; then
            problem "malformed expectation in $case: $line"
        else
            at_top=
        fi
    done <"$case"
    [[ ${expected[exit]=0} =~ ^[0-9]+$ ]] || problem "malformed exit status in $case: ${expected[exit]}"
}

# refuses STATUS TEXT PROGRAM ARGUMENT..: whether the program ends with this exit status, writes one line to standard error in
# which TEXT is found, and leaves no file called bad.something behind. For cases.
refuses() {
    local status=$1 text=$2 code=0
    shift 2
    "$@" 2>said || code=$?
    [ $code -eq "$status" ] && [ "$(wc -l <said)" -eq 1 ] && grep -q -- "$text" said && ! ls bad.* >/dev/null 2>&1 && return
    echo "$*: exit $code, '$(cat said)' does not say '$text', or a file was left"
    return 1
}
# isorender_refuses STATUS TEXT ARGUMENT..: the same for isorender with these arguments and a picture to write.
isorender_refuses() { refuses "$1" "$2" isorender "${@:3}" bad.png --quiet; }
export -f refuses isorender_refuses

touch "$work/stdout" "$work/stderr"
read_expectations
(
    cd "$work/run" || exit 99
    export PATH="$programs:$PATH" TMPDIR="$work/tmp" PYTHONPATH="$here" volumes="$(dirname "$(dirname "$here")")/volumes" PYTHONDONTWRITEBYTECODE=1 LC_ALL=C
    exec bash -eu "$case"
) >"$work/stdout" 2>"$work/stderr" </dev/null
status=$?

[ $status -eq 77 ] && { cat "$work/stdout"; exit 77; }
[ "$status" -eq "${expected[exit]}" ] || problem "status $status instead of ${expected[exit]}"
for stream in stdout stderr; do
    text=$(tr -d '\0' <"$work/$stream")
    # shellcheck disable=SC2053
    [[ ! -v expected[$stream] || $text == ${expected[$stream]} ]] || problem "$stream is not ${expected[$stream]}"
done
left=$(ls -A "$work/tmp")
[ -z "$left" ] || problem "left in TMPDIR: $left"
if [ "${expected[exit]}" -ne 0 ]; then
    left=$(ls -A "$work/run" | grep -v '^in$')
    [ -z "$left" ] || problem "left behind: $left"
    [ "$(grep -c '' "$work/stderr")" -eq 1 ] || problem "not one line on stderr"
fi
exit 0
