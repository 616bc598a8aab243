#!/bin/bash
# Past strokes changed in a real window under Xvfb, with the panel and with Alt and a click on the surface: the saved sculpture is,
# byte for byte, what the same edits give without a window. strokes.sh BIN TOOLS: the folders of the programs and of the tests'
# own programs. Exit status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

# replayed NAME OPTIONS: draws base.strokes without a window
replayed() {
    local name=$1
    shift
    "$bin/isosculpt" --replay base.strokes --headless --quiet --output "$name" "$@" || fail "--replay $*"
}

start
stroke 560 300 60 10
stroke 640 400 60 10
key 2
stroke 700 480 50 20
cp "$journal" base.strokes
"$bin/isosculpt" --replay base.strokes --headless --quiet --output probe.vdb || { echo "skipped: built without OpenVDB"; exit 77; }
picture drawn
# the sections above fold, so that the one of strokes is in the window
press 60 330
press 60 358
lists() { whole_window list && { look color list.png 230 233 238 34,618,44,632 4 >/dev/null || { press 60 571; false; }; }; }
until_ "the section of strokes" lists

# ---- an eye leaves the first stroke out; the picture is that of the two others
mutes() { press 34 645 && xdotool sleep 0.5 && has_events mute 1; }
until_ "an eye" mutes
last mute | grep -q '"stroke":1,"crc"' || fail "mute: $(last mute)"
picture muted
differ drawn muted || fail "a muted stroke is to be seen"

# ---- Alt and a click select the stroke that made the surface there; it makes no stroke itself
click alt 670 405
until_ "the path of a stroke" has_path
has_events begin 3 || fail "a click with Alt draws a stroke"
# its radius changes when the slider is released, once
picture selected
cp "$journal" before.strokes
xdotool mousemove 96 218 sleep 0.2 mousedown 1 sleep 0.2 mousemove 105 218 sleep 0.2 mousemove 112 218 sleep 0.3
has_events edit 0 || fail "a stroke is drawn again while its slider is held"
xdotool mouseup 1
until_ "an edit" has_events edit 1
last edit | grep -q '"stroke":2,' || fail "edit: $(last edit)"
radius=$(last edit | grep -o '"radius":[^,]*' | cut -d: -f2)
awk -v r="$radius" 'BEGIN { exit !(r > 8.5 && r < 20) }' || fail "the slider gives a radius of $radius"
picture larger
differ selected larger || fail "a larger radius is not to be seen"

# ---- undo and redo take it as a step
key ctrl+z
until_ "undo" has_events undo 1
picture undone
cmp selected.png undone.png || fail "undo of an edit: another picture"
key ctrl+shift+z
until_ "redo" has_events redo 1
picture redone
cmp larger.png redone.png || fail "redo of an edit: another picture"

# ---- the key Delete, taken back; then Escape selects nothing
click alt 725 500
until_ "the path of the carved stroke" has_path
key Delete
until_ "a deletion" has_events delete 1
last delete | grep -q '"stroke":3,"crc"' || fail "delete: $(last delete)"
key ctrl+z
until_ "undo of the deletion" has_events undo 2
key Escape Escape
until_ "no path" eval '! has_path'
picture back
cmp larger.png back.png || fail "undo of a deletion: another picture"

# ---- a row that is dragged onto the newest is drawn last
moves() {
    xdotool mousemove 100 625 sleep 0.2 mousedown 1 sleep 0.2 mousemove 100 618 sleep 0.2 mousemove 100 608 sleep 0.2 \
        mousemove 100 605 sleep 0.2 mouseup 1 sleep 0.2
    has_events move 1
}
until_ "a row that is dragged" moves
last move | grep -q '"stroke":2,"crc"' || fail "move: $(last move)"
picture moved
differ larger moved || fail "the order of strokes is not to be seen"

# ---- what is saved is what the same edits give without a window, and what the journal gives
key ctrl+s
until_ "sculpture.vdb" test -s sculpture.vdb
until_ "the title of the saved file" title_is ': sculpture.vdb$'
replayed other.vdb --edit "2:radius=$radius" --mute 1
is_same_field other.vdb && fail "saved without the last edit"
replayed same.vdb --edit "2:radius=$radius" --mute 1 --move 2:end
is_same_field same.vdb || fail "the saved sculpture is not that of the same edits without a window"
cp "$journal" base.strokes
replayed journal.vdb
is_same_field journal.vdb || fail "the journal gives another sculpture"

# ---- edits survive a crash
key f
picture framed
stop
start --recover
until_ "the recovered file" title_is ': sculpture.vdb\*$'
key f
picture recovered
look same framed.png recovered.png 500 || fail "recovered: another picture"
echo "passed"
