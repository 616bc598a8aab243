#!/bin/bash
# Radial symmetry in a real window under Xvfb: the number of images, the axis and its place in the panel, the images of the
# cursor, strokes, and a crash. symmetry.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status
# 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
last() { grep '"event":"begin"' "$journal" | tail -1; }
# images N: the number of images is typed; where the program is slow, keys come before the box for them is open
images() {
    xdotool mousemove 200 274 sleep 0.3 click --repeat 2 --delay 80 1 sleep 0.4
    xdotool key --delay 80 ctrl+a "$1" Return sleep 0.3
}

start
# ---- six images around z: the axis is drawn, and the cursor's images
six() { images 6; xdotool mousemove 852 330 sleep 0.3; whole_window window; look color window.png 120 170 255 780,100,804,160 20 >/dev/null; }
until_ "the axis" six
stroke 700 330 20 20
last | grep -q '"radial":6,"radial_axis":"z"' || fail "no radial stroke: $(last | cut -c1-500)"
picture six
# half a turn shows the same silhouette, as six images have
key shift+1
picture front
key ctrl+1
picture back
front=$(look box front.png) back=$(look box back.png)
[ "$front" = "$back" ] || fail "half a turn: $front and $back"
"$bin/isosculpt" --replay "$journal" --headless --quiet --output six.ply
"$bin/isosculpt" --replay "$journal" --headless --quiet --edit 1:radial=none --output one.ply
cmp -s six.ply one.ply && fail "one image and six are the same"

# ---- the next axis
axis() { press 268 302; stroke 640 250 10 0; last | grep -q '"radial_axis":"x"'; }
until_ "the axis x" axis

# ---- killed and recovered: the symmetry is as before
five() { images 5; stroke 560 400 10 0; last | grep -q '"radial":5,"radial_axis":"x"'; }
until_ "five images" five
before=$journal
xdotool sleep 1
stop
start
until_ "the question" is_modal
key Return
until_ "the answer" is_not_modal
journal=$before # (the new session had one of its own)
stroke 560 450 10 0
last | grep -q '"radial":5,"radial_axis":"x"' || fail "recovered without its symmetry: $(last | cut -c1-500)"

# ---- repeated: the number of copies is typed in the section at the end of the panel, which is scrolled to
stop
anew
start
to_the_end() { xdotool mousemove 150 700 sleep 0.1 click --repeat 30 --delay 10 5 sleep 0.3; }
repeats() {
    to_the_end
    [ -n "${opened:-}" ] || press 60 779
    opened=yes
    to_the_end
    xdotool mousemove 100 695 sleep 0.3 click --repeat 2 --delay 80 1 sleep 0.4
    xdotool key --delay 80 ctrl+a 3 Return sleep 0.3
    stroke 620 400 0 20
    last | grep -q '"repeat":\[3,[01]\],"repeat_by":\[\[16.0,0.0,0.0\]'
}
until_ "three copies" repeats
picture three
"$bin/isosculpt" --replay "$journal" --headless --quiet --output three.ply
"$bin/isosculpt" --replay "$journal" --headless --quiet --edit 1:repeat=none --output one.ply
cmp -s three.ply one.ply && fail "three copies and one are the same"
echo "passed"
