#!/bin/bash
# Painting in a real window under Xvfb: strokes with a colour, taking paint away, undo, the colour under the pointer, the file
# with colours, and a crash. paint.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77:
# skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

last_color() { grep '"event":"begin"' "$journal" | tail -1 | grep -o '"color":"#[0-9a-f]*"' | cut -d'"' -f4; }
# has_color NAME R G B BOX N: whether the picture shows the colour in the box
has_color() { look color "$@" >/dev/null; }
# save_as NAME
save_as() {
    until_ "the browser" eval 'key ctrl+shift+s; is_modal'
    xdotool key --delay 50 ctrl+a
    xdotool type --delay 30 "$1"
    xdotool sleep 0.3 key Return
    until_ "$1" test -s "$1"
    until_ "the title of the saved file" title_is ": $1\$"
}
MIDDLE=440,350,536,450

start
picture clay
has_color clay.png 150 50 28 $MIDDLE 50 && fail "a new ball is red"

# ---- a stroke paints, and does not move the surface
key p
stroke 600 400 80 0
[ "$(tools)" = "paint " ] || fail "tools: $(tools)"
[ "$(last_color)" = "#d84828" ] || fail "colour: $(last_color)"
picture red
has_color red.png 216 72 40 400,300,576,500 400 || fail "the stroke is not to be seen"
key ctrl+z
until_ "undo" has_events undo 1
picture undone
cmp clay.png undone.png || fail "undo leaves paint"
key ctrl+shift+z
until_ "redo" has_events redo 1
picture redone
cmp red.png redone.png || fail "redo gives another picture"

# ---- with Alt it takes paint away
xdotool keydown alt
stroke 600 400 80 0
xdotool keyup alt
[ "$(last_color)" = "" ] || fail "a stroke that takes paint away has a colour"
picture taken
differ red taken || fail "paint is not taken away"
key ctrl+z
until_ "undo" has_events undo 2

# ---- the colour under the pointer, with which another brush builds up
xdotool mousemove $((540 + PANEL / 2)) 500 sleep 0.2
key e
stroke 540 520 10 0
[ "$(last_color)" = "#ce8e70" ] || fail "the colour of the surface: $(last_color)"
picture painted
cp "$journal" before.strokes

# ---- isorender draws what the window shows, from a saved .vdb (if OpenVDB is there)
if "$bin/isosculpt" --replay "$journal" --headless --quiet --output probe.vdb; then
    save_as painted.vdb
    picture saved
    "$bin/isorender" --again saved.png -o again.png --quiet || fail "saved.png: its scene cannot be drawn"
    look near saved.png again.png 1 || fail "saved.png: isorender draws another picture than the window's"
fi

# ---- what is exported is what the journal gives, with colours
save_as painted.ply
"$bin/isosculpt" --replay "$journal" --headless --quiet --mesh replayed.ply || fail "--replay"
cmp painted.ply replayed.ply || fail "the saved mesh is not that of the journal"
grep -aq "property uchar red" painted.ply || fail "the mesh has no colours"

# ---- paint survives a crash
stop
start --recover
until_ "the recovered file" title_is ': painted.ply\*$'
picture recovered
look same painted.png recovered.png 500 || fail "recovered: another picture"
stop

# ---- a coloured mesh is opened with its colours, which a stroke without one covers, and undo brings back
rm -rf "$state"
start --open painted.ply --voxel-size 0.5
until_ "the mesh" title_is 'painted.ply'
head -1 "$journal" | grep -q '"colors":true' || fail "the journal does not say that the session began with colours"
picture opened
has_color opened.png 216 72 40 400,300,576,500 400 || fail "the mesh has no colours in the window"
key 1
stroke 600 400 80 0
until_ "a stroke" has_events end 1
picture covered
differ opened covered || fail "the stroke is not to be seen"
key ctrl+z
until_ "undo" has_events undo 1
picture back
cmp opened.png back.png || fail "undo does not bring the mesh's colours back"
echo "passed"
