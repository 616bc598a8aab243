#!/bin/bash
# A real window under Xvfb, driven with xdotool; the results of mouse and keys are checked in the journal, the saved files
# and the pictures. run.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped,
# as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"

# ---- without a window
require_window
code=$?
[ $code -eq 4 ] || fail "no display: exit status $code, not 4"
grep -q -- "--headless" "$work/said" || fail "no display: --headless is not named"

open_display
cd "$work" || exit 1 # where a new ball is saved

start
picture new # and so it is ready

# ---- every brush on the ball; modifier keys; strokes beside the ball do not change the field
for of in "1 560 290" "2 700 290" "3 640 260" "4 560 390" "5 640 340" "6 720 390" "7 560 480" \
    "8 640 440" "0 620 300" "t 680 340" "l 600 420" "w 700 440" "j 660 480" "9 700 500"; do
    key "${of%% *}"
    # shellcheck disable=SC2086
    stroke ${of#* } 30 20
done
picture masked
xdotool keydown alt
stroke 700 500 30 20
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
for brush in 0 t; do # what clay and scrape are inverted
    key $brush
    xdotool keydown ctrl
    stroke 600 420 10 20
    xdotool keyup ctrl
done
expected="add carve blend-add smooth inflate flatten pinch move clay scrape fill crease snake-hook mask unmask smooth"
expected="$expected carve carve scrape fill "
[ "$(tools)" = "$expected" ] || fail "tools: $(tools)"
picture sculpted
cmp -s "$work/new.png" "$work/sculpted.png" && fail "strokes are not to be seen"

# ---- undo and redo restore every bit of the picture; beyond the first and last step they do nothing
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

# ---- saving; the saved file is the field that the journal replays to
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
look same "$vdb.look/model.png" "$work/replayed.vdb.look/model.png" 0 >/dev/null || fail "what was saved is not what was sculpted"

cp "$journal" "$work/kept.strokes"

# ---- closing asks when there are unsaved changes
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
anew
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

# ---- a window on a file, and then on the stroke file of that session
kill -9 "$program"
wait "$program" 2>/dev/null
anew
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

# ---- opening another file by its name in the panel; a name that does not exist changes nothing
before=$journal
open_by_name() {
    press 90 554
    xdotool key --delay 100 ctrl+a
    xdotool type "$1"
    xdotool sleep 0.2 key Return
}
another_journal() { [ "$(newest)" != "$before" ]; }
open_by_name "$work/nothing.stl"
picture unmoved
cmp -s "$work/unmoved.png" "$work/continued.png" || fail "a file that is not there takes the session away"
for try in 1 2 3 4 5; do
    open_by_name "$work/replayed.vdb"
    for wait in {1..50}; do another_journal && break 2 || sleep 0.1; done
done
until_ "another journal" another_journal
is_opened() { picture moved && cmp -s "$work/moved.png" "$work/opened.png"; }
until_ "what was opened by its name looks as what was opened before" is_opened
[ ! -e "$before.open" ] || fail "the journal before still counts as open"
stop

# ---- a mesh as a stamp: the journal contains it, and replays without its file
anew
"$bin/isosculpt" --replay "$work/kept.strokes" --headless --quiet --output "$work/shape.stl" || fail "no mesh for a stamp"
start --stamp "$work/shape.stl"
until_ "the stamp in the journal" has_events stamp 1
rm "$work/shape.stl"
picture unstamped
stroke 640 400 0 0
grep -q '"shape":"stamp"' "$journal" || fail "the stamp is not used"
picture stamped
cmp -s "$work/unstamped.png" "$work/stamped.png" && fail "a stamp is not to be seen"
key ctrl+z
picture unstamped_again
cmp "$work/unstamped.png" "$work/unstamped_again.png" || fail "undo of a stamp: another picture"
key ctrl+shift+z ctrl+s
until_ "$vdb" test -s "$vdb"
cp "$journal" "$work/stamped.strokes"
"$bin/isosculpt" --replay "$work/stamped.strokes" --headless --quiet --output "$work/stamped.vdb" || fail "the stamp does not play"
cmp <(tail -c +60 "$vdb") <(tail -c +60 "$work/stamped.vdb") || fail "the stamp plays to another field"
stop

# ---- a volume is shown as a volume, at an isovalue chosen from its histogram, until a brush is used
anew
cp "$volumes/stent.nrrd" "$work/stent.nrrd" # (pictures lie beside it)
window_program "$work/stent.nrrd" --isovalue 600
until_ "the volume" title_is 'stent.nrrd'
picture unmoved
journal_is_there && fail "a journal, though nothing was done"
slides() {
    xdotool mousemove 120 100 sleep 0.2 mousedown 1 sleep 0.2 mousemove 140 100 sleep 0.2 mouseup 1 sleep 0.2
    picture moved
    differ unmoved moved
}
until_ "another isovalue" slides
is_sculpted() {
    press 50 289 # "Sculpt this"
    journal_is_there
}
until_ "a field" is_sculpted
isovalue=$(grep -o '"isovalue":[^,]*' "$journal" | cut -d: -f2)
awk "BEGIN { exit !($isovalue != 600) }" || fail "the histogram changes nothing"
stop
"$bin/isosculpt" --replay "$journal" --headless --quiet --output "$work/stent.vdb" || fail "strokes on a volume do not play"

# ---- Escape cancels the opening of a file
anew
"$bin/isosculpt" --replay "$work/kept.strokes" --headless --quiet --output "$work/shape.stl" || fail "no mesh to open"
"$bin/isosculpt" "$work/shape.stl" --voxel-size 0.1 >"$work/said" 2>&1 &
program=$!
until_ "a window" window_is_there
cancelled() { key Escape && journal_is_there; }
until_ "a session without what was cancelled" cancelled
grep -q '"source":"ball"' "$journal" || fail "Escape: $(head -c 100 "$journal")"
picture cancelled
stop

# ---- text twice as large: the window is also larger, but fits on its screen
if command -v xrdb >/dev/null; then
    anew
    echo "Xft.dpi: 192" | xrdb -merge -
    start
    picture large
    fits() { xdotool search --onlyvisible --name '^isosculpt' getwindowgeometry | grep -q 'Geometry: 1280x800'; }
    until_ "a window that fits" fits
    stroke 640 400 20 20
    picture large_stroke
    cmp -s "$work/large.png" "$work/large_stroke.png" && fail "text twice as large: strokes are not to be seen"
    stop
    xrdb -remove
fi

# ---- the content scale changes while the program runs: buttons change their positions and sizes
if [ -e "$tools/libwindow_scale.so" ]; then
    anew
    export ISO_TEST_SCALE=$work/scale
    LD_PRELOAD=$tools/libwindow_scale.so start
    stroke 640 400 20 20
    # press X Y TOOL: a button that chooses a brush; the panel may not be there yet
    chosen_by_press() {
        xdotool mousemove "$1" "$2" sleep 0.1 mousedown 1 sleep 0.2 mouseup 1 sleep 0.1
        stroke 800 400 20 20
        [ "$(tools | awk '{ print $NF }')" = "$3" ]
    }
    until_ "scale 1: carving" chosen_by_press 152 50 carve
    key 1
    echo 2 >"$work/scale"
    until_ "scale 2: carving" chosen_by_press 304 100 carve
    key 1
    echo 1 >"$work/scale"
    until_ "scale 1 again: carving" chosen_by_press 152 50 carve
    stop
    unset ISO_TEST_SCALE
fi
"$bin/isosculpt" "$work/nothing.stl" 2>"$work/said"
code=$?
[ $code -eq 3 ] && grep -q "nothing.stl" "$work/said" || fail "a file that is not there: exit status $code, not 3"
echo "passed"
