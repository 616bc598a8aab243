#!/bin/bash
# Mouse and keys on volumes and meshes in a real window under Xvfb: moving the camera, strokes that wait until the field is
# ready, the mirror, the histogram, and the isorender command that draws the view. hands.sh BIN TOOLS: the folders of the
# programs and of the tests' own programs. Exit status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_clipboard
require_window
make_box "$work/box.obj" 100 0 0 20
"$bin/isosculpt" --open "$work/box.obj" --headless --quiet --voxel-size 1 --output "$work/probe.vdb" ||
    { echo "skipped: built without OpenVDB"; exit 77; }
open_display
cd "$work" || exit 1
cp "$volumes/stent.nrrd" "$work/stent.nrrd"

box_of() { look box "$work/$1.png"; }

# ---- a volume: the left button orbits until a brush is chosen
window_program stent.nrrd --isovalue 600
until_ "the volume" title_is 'stent.nrrd'
picture volume
orbits() {
    drag 1 640 400 60 20
    picture orbit
    differ volume orbit
}
until_ "a drag on a volume orbits" orbits
journal_is_there && fail "a drag on a volume sculpts it"
copy_command 105 457
draws orbit 0
key M # the same view by the other methods: pixels at edges may differ
picture discs
key M M M M M

# ---- the histogram: its ends, its marks, and the isovalues that --info suggests
whole_window histogram
look color histogram.png 140 235 140 12,38,292,54 20 || fail "Otsu's threshold is not marked"
look color histogram.png 110 190 120 12,38,292,54 20 || fail "the other suggested isovalues are not marked"
look color histogram.png 184 189 196 12,152,110,168 20 || fail "the histogram has no numbers"
suggested=$("$bin/isorender" stent.nrrd --info | sed -n 's/^ *isovalues *\([^,]*\), \([^,]*\), \([^ ]*\).*/\3/p')
picks() {
    press 249 209
    picture third
    differ orbit third
}
until_ "the third suggestion" picks

# ---- a brush is chosen and strokes are made immediately: they wait until the field is ready
key Shift+1
picture front
key 2
drag 1 758 575 0 40
drag 1 755 600 12 0
until_ "a field" journal_is_there
until_ "two strokes" has_events end 2
[ "$(tools)" = "carve carve " ] || fail "strokes that waited: $(tools)"
grep -q "\"isovalue\":$suggested" "$journal" || fail "isovalue: $(head -c 300 "$journal"), not $suggested"
picture carved
differ front carved || fail "strokes that waited are not to be seen"
key ctrl+z ctrl+z
picture field
key ctrl+shift+z ctrl+shift+z
picture redone
differ field redone || fail "strokes that waited cannot be undone"
cmp carved.png redone.png || fail "strokes that waited: redone otherwise"

# ---- a field: the command needs a saved file, which it draws
press 105 470
says_no() { press 105 470; says "No command"; }
until_ "a command without a file" says_no
key ctrl+s
until_ "stent.vdb" test -s "$work/stent.vdb"
picture saved
copy_command 105 470
draws saved 60
stop

# ---- the camera without wheel, middle button or number pad; pictures are compared by the object's box x0 y0 x1 y1
anew
start box.obj --voxel-size 0.5
until_ "its title" title_is ': box.obj$'
journal=$(newest)
picture framed
read -r x0 y0 x1 y1 <<<"$(box_of framed)"
moves() { # moves NAME TEXT: the box is another, as an expression of old (x0 ..) and new (a0 ..) says
    read -r a0 b0 a1 b1 <<<"$(box_of "$1")"
    awk -v x0="$x0" -v y0="$y0" -v x1="$x1" -v y1="$y1" -v a0="$a0" -v b0="$b0" -v a1="$a1" -v b1="$b1" \
        "BEGIN { exit !($2) }" || fail "$1: from $x0 $y0 $x1 $y1 to $a0 $b0 $a1 $b1"
}
key plus
picture larger
moves larger "a1 - a0 > 1.1 * (x1 - x0) && b1 - b0 > 1.1 * (y1 - y0)"
key minus minus
picture smaller
moves smaller "a1 - a0 < 0.9 * (x1 - x0) && b1 - b0 < 0.9 * (y1 - y0)"
key KP_Add Right
picture right
moves right "a0 > x0 + 40 && a1 > x1 + 40 && b0 - y0 <= 2 && y0 - b0 <= 2"
key Left Up
picture up
moves up "b0 < y0 - 40 && a0 - x0 <= 2 && x0 - a0 <= 2"
key Down
drag 3 1050 650 50 30
picture panned
moves panned "a0 - x0 >= 45 && a0 - x0 <= 70 && b0 - y0 >= 25 && b0 - y0 <= 45" # (nearer than what it turns about)
key f
picture again
moves again "a0 - x0 <= 1 && x0 - a0 <= 1 && b1 - y1 <= 1 && y1 - b1 <= 1"

# ---- views from the sides: the position of the eye is in the command
# eye_is KEY AXIS SIGN: fails unless KEY moves the eye so that it is in this direction from the focal point
eye_is() {
    key "$1"
    copy_command 105 470
    python3 - "$command" "$2" "$3" <<'PYTHON' || fail "$1: $command"
import re, sys
def vector(name):
    return [float(v) for v in re.search(name + r"=(\S+)", sys.argv[1]).group(1).split(",")]
arm = [a - b for a, b in zip(vector("position"), vector("focal-point"))]
axis = max(range(3), key=lambda i: abs(arm[i]))
sys.exit(not (axis == "xyz".index(sys.argv[2]) and (arm[axis] > 0) == (sys.argv[3] == "+")))
PYTHON
}
key ctrl+s # (what is not saved has no command)
until_ "box.vdb" test -s "$work/box.vdb"
eye_is ctrl+1 y +
eye_is shift+1 y -
eye_is ctrl+3 x +
eye_is shift+3 x -
eye_is ctrl+7 z -
eye_is shift+7 z +
eye_is KP_1 y -
eye_is ctrl+KP_1 y +
eye_is KP_3 x -
eye_is ctrl+KP_3 x +
eye_is KP_7 z +
eye_is ctrl+KP_7 z -
key shift+1

# ---- F frames the object in its present form
stroke 740 340 0 0
for repeat in 1 2 3; do stroke $((760 + 20 * repeat)) $((330 - 20 * repeat)) 10 -10; done
picture sculpted
key f
picture grown
differ sculpted grown || fail "F frames the object as it was"
read -r a0 b0 a1 b1 <<<"$(box_of grown)"
awk "BEGIN { exit !($a0 > 20 && $b0 > 20 && $a1 < 956 && $b1 < 780 && $b1 - $b0 > 350) }" ||
    fail "F: the object is not in the picture: $a0 $b0 $a1 $b1"
for repeat in 1 2 3 4; do key ctrl+z; done
key f
picture small
cmp small.png again.png || fail "undone, it is not framed as before"

# ---- the mirror: its plane is in the middle of the object (110, 10, 10) and shown as a line; strokes act on both sides
symmetry() { press 72 274; whole_window mirror; look color "$work/mirror.png" 255 120 110 320,0,1280,800 100; }
until_ "the mirror's line" symmetry
read -r x0 y0 x1 y1 <<<"$(box_of small)"
look color mirror.png 255 120 110 $((PANEL + (x0 + x1) / 2 - 3)),"$y0",$((PANEL + (x0 + x1) / 2 + 3)),"$y1" 100 || fail "the line is not in the middle"
key 1
stroke 720 400 0 0
awk_mirror() { tail -4 "$journal" | grep -o '"mirror":\[[^]]*' | tail -1 | cut -d[ -f2; }
mirror=$(awk_mirror)
awk -v m="$mirror" 'BEGIN { split(m, v, ","); exit !(v[1] > 109.7 && v[1] < 110.3 && v[2] > 9.7 && v[2] < 10.3) }' ||
    fail "the mirror is at $mirror"
picture both
read -r a0 b0 a1 b1 <<<"$(box_of both)"
awk "BEGIN { exit !($a0 + $a1 - $x0 - $x1 <= 3 && $x0 + $x1 - $a0 - $a1 <= 3) }" || fail "one side: $a0 $a1"

# ---- another file begins without a mirror, and has its own middle
make_box other.obj -60 7 0 12
before=$journal
press 90 582 # the box for a name, one row lower now that the mirror has one
xdotool key --delay 100 ctrl+a
xdotool type "$work/other.obj"
xdotool sleep 0.2 key Return
until_ "a question" is_modal
key o # (means nothing here)
key Return
other() { [ "$(newest)" != "$before" ] && head -1 "$(newest)" | grep -qF '/other.obj"'; }
until_ "other.obj" other
journal=$(newest)
until_ "its title" title_is ': other.obj$'
picture other
stroke 640 400 0 0
tail -4 "$journal" | grep -q '"symmetry":0' || fail "another file: the symmetry of the one before"
mirror=$(awk_mirror)
awk -v m="$mirror" 'BEGIN { split(m, v, ","); exit !(v[1] > -54.3 && v[1] < -53.7 && v[2] > 12.7 && v[2] < 13.3) }' ||
    fail "another file: the mirror is at $mirror"
echo "passed"
