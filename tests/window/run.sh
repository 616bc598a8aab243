#!/bin/bash
# A real window under Xvfb, driven with xdotool: what mouse and keys do is read from the journal, the saved
# files and the pictures. run.sh BIN, the folder of the programs. 77: nothing to drive it with.
set -u
bin=$(cd "$1" && pwd)
. "$(dirname "$0")/support.sh"

# ---- without a window
env -u DISPLAY "$bin/isosculpt" 2>"$work/said"
code=$?
grep -q "built without GLFW" "$work/said" && { echo "skipped: built without a window"; exit 77; }
[ $code -eq 4 ] || fail "no display: exit status $code, not 4"
grep -q -- "--headless" "$work/said" || fail "no display: --headless is not named"

open_display

start
picture new # and so it is ready

# ---- every brush, where the ball is; modifiers; beside it nothing happens to the field
brush=0
for at in "560 290" "700 290" "640 260" "560 390" "640 340" "720 390" "560 480" "640 440" "700 500"; do
    brush=$((brush + 1))
    key $brush
    # shellcheck disable=SC2086
    stroke $at 30 20
done
picture masked
xdotool keydown alt
# shellcheck disable=SC2086
stroke $at 30 20
xdotool keyup alt
picture free
cmp -s "$work/masked.png" "$work/free.png" && fail "what is frozen does not look it"
key 1
xdotool keydown shift
stroke 620 400 20 10
xdotool keyup shift keydown alt
stroke 660 520 20 10
xdotool keyup alt keydown ctrl
stroke 520 420 10 20
xdotool keyup ctrl
expected="add carve blend-add smooth inflate flatten pinch move mask unmask smooth carve carve "
[ "$(tools)" = "$expected" ] || fail "tools: $(tools)"
picture sculpted
cmp -s "$work/new.png" "$work/sculpted.png" && fail "strokes are not to be seen"

# ---- undo brings back every bit of the picture, redo the other; more of them than there are do nothing
strokes=$(events end)
mapfile -t keys < <(yes ctrl+z | head -n $((strokes + 2)))
key "${keys[@]}"
picture undone
cmp "$work/undone.png" "$work/new.png" || fail "undo: another picture"
key "${keys[@]/ctrl+z/ctrl+shift+z}"
picture redone
cmp "$work/redone.png" "$work/sculpted.png" || fail "redo: another picture"
has_events undo "$(events redo)" || fail "as many undone as redone"

# ---- the camera: orbit beside the ball and with the middle button, pan, wheel, views
drag 1 1100 650 60 40
picture orbit
cmp -s "$work/redone.png" "$work/orbit.png" && fail "a drag beside the surface does not orbit"
drag 2 640 400 40 0
drag 3 640 400 30 30
xdotool click 4 click 5 click 4
key KP_1
key bracketright
key f
has_events end "$strokes" || fail "moving the camera made strokes"
picture front

# ---- saving; what is saved is what the journal says
vdb=${journal%.strokes}.vdb
key ctrl+s
until_ "$vdb" test -s "$vdb"
"$bin/isosculpt" --replay "$journal" --headless --quiet --output "$work/replayed.vdb" --json="$work/replay.json" ||
    fail "the journal does not play"
grep -q "\"strokes\": $strokes," "$work/replay.json" || fail "the journal has other strokes"
for name in "$vdb" "$work/replayed.vdb"; do
    mkdir "$work/look"
    cp "$name" "$work/look/model.vdb"
    (cd "$work/look" && "$bin/isorender" model.vdb model.png --resolution 200x200 --quiet) || fail "$name"
    mv "$work/look" "$name.look"
done
cmp "$vdb.look/model.png" "$work/replayed.vdb.look/model.png" || fail "what was saved is not what was sculpted"

# ---- closing asks while there is something to save
stroke 640 400 20 20
key ctrl+q
key Escape
picture stayed
stroke 600 420 20 20 # so it stayed
key ctrl+q
key Return
closing=$program
program=
until_ "closing" has_ended "$closing"
wait "$closing"
code=$?
[ $code -eq 0 ] || fail "exit status $code"
[ -s "$vdb.bak" ] || fail "the file before is not kept"
[ ! -e "$journal.open" ] || fail "the journal still counts as open"

# ---- killed, and recovered
rm -rf "$state"
start
picture new
stroke 640 400 20 20
kill -9 "$program"
wait "$program" 2>/dev/null
[ -e "$journal.open" ] || fail "nobody will know that it was not closed"
before=$journal
start --recover
[ "$journal" = "$before" ] || fail "another journal: $journal"
picture recovered
stroke 560 380 20 20
[ "$(tools)" = "add add " ] || fail "after recovery: $(tools)"

# ---- a window on a file, and again on the strokes that began with it
kill -9 "$program"
wait "$program" 2>/dev/null
rm -rf "$state"
start "$work/replayed.vdb"
picture opened
stroke 640 400 20 20
key ctrl+q
key Return
closing=$program
program=
until_ "closing" has_ended "$closing"
start "$journal"
picture continued
cmp -s "$work/opened.png" "$work/continued.png" && fail "the stroke on an opened file is lost"
has_events end 1 || fail "strokes on an opened file: $(events end)"
kill -9 "$program"
wait "$program" 2>/dev/null
program=
"$bin/isosculpt" "$work/nothing.stl" 2>"$work/said"
code=$?
[ $code -eq 3 ] && grep -q "nothing.stl" "$work/said" || fail "a file that is not there: exit status $code, not 3"
echo "passed"
