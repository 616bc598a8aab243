#!/bin/bash
# A label of a segmentation in a real window under Xvfb, among the other labels, all in the colours of the file.
# labels.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped, as something
# needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

# label 7 in the middle, 2 (red) before it, 3 (green) behind it, 5 (blue) to the left; and 7 alone
python3 - <<'P'
head = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 64 64 64\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n")
for i, (label, name, color) in enumerate(((7, "middle", ".9 .8 .6"), (2, "front", "1 0 0"), (3, "back", "0 .7 0"), (5, "left", "0 0 1"))):
    head += f"Segment{i}_LabelValue:={label}\nSegment{i}_Name:={name}\nSegment{i}_Color:={color}\nSegment{i}_Layer:=0\n"
balls = ((7, 32, 32, 32, 15), (2, 32, 12, 32, 9), (3, 32, 54, 34, 8), (5, 52, 32, 40, 11))
for name, used in (("in.seg.nrrd", balls), ("alone.seg.nrrd", balls[:1])):
    voxels = bytes(next((b[0] for b in used if (x - b[1]) ** 2 + (y - b[2]) ** 2 + (z - b[3]) ** 2 < b[4] ** 2), 0)
                   for z in range(64) for y in range(64) for x in range(64))
    with open(name, "wb") as file:
        file.write((head + "\n").encode() + voxels)
P
ALL=0,0,9999,9999
has_red() { look color "$1.png" 200 35 30 $ALL 2000 >/dev/null; }
has_blue() { look color "$1.png" 12 12 165 $ALL 5000 >/dev/null; }
has_sand() { look color "$1.png" 185 165 122 $ALL 9000 >/dev/null; }
has_green() { look color "$1.png" 10 110 10 $ALL 500 >/dev/null; }

# ---- the others are seen from the start: those that the label does not hide
start --open in.seg.nrrd --label 7
shown() {
    picture shown
    has_red shown && has_blue shown && has_sand shown
}
until_ "the other labels" shown
has_green shown && fail "a label is seen that lies behind the sculpted one"
key ctrl+1
behind() {
    picture behind
    has_green behind
}
until_ "the label behind, from behind" behind
has_red behind && fail "the label before is seen from behind"
back() {
    picture back
    cmp -s shown.png back.png
}
key shift+1
until_ "the same picture from the front" back

# ---- picks do not know them: a stroke begins at the same place without them
stroke 560 400 20 0
first=$(grep '"event":"begin"' "$journal" | tail -1 | grep -o '"at":[^]]*')
key ctrl+z
hidden() {
    press 23 526
    picture hidden
    ! has_red hidden && ! has_blue hidden
}
until_ "the label alone" hidden
stroke 560 400 20 0
[ "$(grep '"event":"begin"' "$journal" | tail -1 | grep -o '"at":[^]]*')" = "$first" ] || fail "a stroke begins elsewhere"
key ctrl+z

# ---- R shows them again; the x-ray of the beginning takes their place, and gives it back
again() {
    picture again
    has_red again && has_blue again
}
key r
until_ "the other labels again" again
cmp shown.png again.png || fail "the other labels look different"
x_ray() {
    press 23 498
    picture x_ray
    ! has_red x_ray && ! has_blue x_ray
}
until_ "the x-ray instead" x_ray
others() {
    press 23 526
    sleep 0.5
    again
}
until_ "the other labels instead of the x-ray" others
cmp shown.png again.png || fail "after the x-ray, the other labels look different"
stop

# ---- where there is no other label, the panel has no checkbox of them, and nothing is said
anew
start --open alone.seg.nrrd --label 7
sleep 1
alone() {
    whole_window alone
    has_sand alone && ! look color alone.png 55 122 226 12,516,34,537 1 >/dev/null # the mark of a checked box
}
until_ "a panel without other labels" alone
says "No reference" && fail "a mask's other labels are missed"
stop
echo "passed"
