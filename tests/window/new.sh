#!/bin/bash
# New solids, measuring, blurring the mask and another voxel size in a real window under Xvfb. new.sh BIN TOOLS: the folders of
# the programs and of the tests' own programs. Exit status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
# begins WORDS: whether the newest journal's first line has the words
begins() { journal=$(newest) && head -1 "$journal" | grep -qF "$1"; }

asks() { is_modal && [ "$(newest)" = "$journal" ]; }

start
# ---- the dialog: a torus from the list; a thinner one than voxels can show is refused, and Escape leaves all as it is
key ctrl+n
until_ "a dialog" is_modal
lists() { press 605 360; press 553 469; whole_window torus; look color torus.png 230 233 238 690,405,760,425 8 >/dev/null; }
lists
press 605 402 && key ctrl+a && xdotool type 0.05 && sleep 0.3
whole_window refused

look color refused.png 255 107 92 520,440,820,560 20 >/dev/null || fail "a tube that is too thin is not refused"
key Return
until_ "the dialog stays" is_modal
# (typed again if the loaded machine has lost a key: the dialog stays then)
for _ in 1 2 3; do
    press 575 394 && key ctrl+a && xdotool type 20 && sleep 0.3
    key Return
    for _ in $(seq 50); do is_modal && sleep 0.1 || break 2; done
done
until_ "a torus" begins '"source":"torus"'
begins '"version":5' && begins '"size":[80.0,80.0,20.0]' || fail "$(head -1 "$journal")"
until_ "no dialog" is_not_modal
key shift+7
picture ring
look color ring.png 45 48 56 480,390,496,410 100 >/dev/null || fail "the ring has no hole"

# ---- measuring: clicks pick places and draw nothing, a brush ends it
key d
xdotool mousemove 792 230 sleep 0.3 click 1 sleep 0.3
measured() { whole_window measured; look color measured.png 120 230 255 640,80,940,500 "$1" >/dev/null; }
until_ "a measured place" measured 30
xdotool mousemove 792 570 sleep 0.3 click 1 sleep 0.3
until_ "a distance" measured 300
has_events begin 0 || fail "measuring made a stroke"
key 1

# ---- the mask: blurring smooths its border, as one step
key 9
stroke 640 230 6 0
picture masked
key 1
press 116 301
until_ "a blurred mask" eval '[ "$(tools)" = "mask blur-mask " ]'
picture blurred
differ masked blurred || fail "blurring changes nothing"
key ctrl+z
until_ "undo" has_events undo 1
picture again
cmp -s masked.png again.png || fail "undo gives another mask"

# ---- another voxel size: all strokes are played again, and the file before stays
stroke 640 230 40 0
before=$journal
cp "$before" before.strokes
for _ in 1 2 3 4 5 6 7 8 9 10; do xdotool mousemove 150 700 click 5 sleep 0.1; done
press 208 671 # "Volume and area"
press 60 587  # "Numbers"
press 65 675 && key ctrl+a && xdotool type 0.8 && sleep 0.2
press 165 675
until_ "other voxels" begins '"voxel_size":0.8'
until_ "all strokes" has_events end 3
cmp -s "$before" before.strokes || fail "the strokes before are not as they were"
picture coarse
differ again coarse || fail "the strokes are not there"
cp "$journal" after.strokes
key ctrl+z
until_ "undo" has_events undo 2
picture undone
differ coarse undone || fail "nothing is undone"
for name in before after; do
    "$bin/isosculpt" --replay $name.strokes --headless --quiet --voxel-size 0.8 --output $name.ply || fail "$name.strokes"
done
cmp before.ply after.ply || fail "a replay gives another surface"

# ---- with unsaved changes a new solid asks first; here it is given by an option, with its voxels
stop
anew
start --new box:40x30x20,round=4 --voxel-size 0.4
begins '"source":"box"' && begins '"round":4.0' && begins '"voxel_size":0.4' || fail "$(head -1 "$journal")"
stroke 640 400 40 0
press 143 554 # "New..."
until_ "a dialog" is_modal
key Return
until_ "a question" asks
key Escape
until_ "no dialog" is_not_modal
begins '"source":"box"' || fail "Escape began anew"
key ctrl+n
until_ "a dialog" is_modal
key Return
until_ "a question" asks
stop

# ---- what a viewed volume's second isovalue encloses is frozen when the volume is sculpted, as the first stroke
anew
python3 - <<'PYTHON'
import struct
at = [i - 23.5 for i in range(48)]
data = b"".join(struct.pack("<f", 100 - (x * x + y * y + z * z) ** 0.5) for z in at for y in at for x in at)
with open("head.nrrd", "wb") as file:
    file.write(b"NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 48 48 48\nendian: little\n"
               b"encoding: raw\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-23.5,-23.5,-23.5)\n\n" + data)
PYTHON
window_program head.nrrd --isovalue 80
until_ "the volume" title_is 'head.nrrd'
two() { press 23 261; whole_window two; look color two.png 240 143 219 12,38,292,150 60 >/dev/null; }
until_ "a second isovalue" two
press 229 261 # "freeze"
press 50 345  # "Sculpt this"
until_ "a field" journal_is_there
until_ "frozen voxels" has_events end 1
[ "$(tools)" = "mask-voxels " ] && grep -q '"frozen":"' "$journal" || fail "tools: $(tools)"
key 2
stroke 640 400 4 0
cp "$journal" frozen.strokes
"$bin/isosculpt" --replay frozen.strokes --headless --quiet --measure --json=frozen.json || fail "the strokes do not replay"
"$bin/isosculpt" --replay frozen.strokes --headless --quiet --mute 1 --measure --json=free.json || fail "they cannot be edited"
python3 - <<'PYTHON' || fail "the second isovalue's inside was carved"
import json
frozen, free = (json.load(open(name + ".json"))["measured"]["volume"] for name in ("frozen", "free"))
assert frozen > free + 20, (frozen, free)
PYTHON
picture bone
echo "passed"
