#!/bin/bash
# Drops files on a real window under Xvfb, by the protocol of file managers: all kinds that can be opened, files that cannot
# be read, and the questions about unsaved changes. files.sh BIN TOOLS: the folders of the programs and of the tests'
# own programs. Exit status 77: skipped, as something needed is missing.
set -u
source_folder=$(cd "$(dirname "$0")/../.." && pwd)
. "$(dirname "$0")/support.sh"
[ -x "$tools/window_drop" ] || { echo "skipped: built without X11"; exit 77; }
require_window
trap 'kill -9 $program $closing $server 2>/dev/null; wait 2>/dev/null; rm -rf "$work"' EXIT
open_display
cd "$work" || exit 1

# ---- one file of each kind; a name that a list of URIs has to encode
files="$work/b\"ü %"
mkdir "$files"
printf 'v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >"$files/mesh.obj"
"$bin/isosculpt" --open "$files/mesh.obj" --headless --quiet --voxel-size 1 --output "$files/field.vdb" --mesh "$files/mesh.ply" ||
    { echo "skipped: built without OpenVDB"; exit 77; }
python3 - "$files/ball.nrrd" <<'END'
import sys
side = 40
with open(sys.argv[1], "wb") as file:
    file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 40 40\nencoding: raw\n\n")
    file.write(bytes(250 - ((x - 20) ** 2 + (y - 20) ** 2 + (z - 20) ** 2) // 5
                     for z in range(side) for y in range(side) for x in range(side)))
END
echo "no field" >"$files/damaged.vdb"
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >"$files/points.ply"

drop() { "$tools/window_drop" "$(window_number)" 640 400 "$@" || fail "dropping $*: exit status $?"; }
said() { grep -qF "$1" "$work/said"; }
# began_with NAME: whether there is a new journal, of a session that began with that file
began_with() { [ "$(newest)" != "$before" ] && head -1 "$(newest)" | grep -qF "/$1\"" && title_is ": $1\$"; }
# opens NAME: waits for such a journal, and sets $journal to it
opens() {
    before=$journal
    until_ "$1" began_with "$1"
    journal=$(newest)
}
# shows_trouble: whether the lower part of the window shows an error message, which is red
shows_trouble() {
    whole_window trouble
    local file=$work/trouble.png
    python3 - "$source_folder/tests/cli" "$file" <<'END'
import sys
sys.path.insert(0, sys.argv[1])
from check import Png
rows = Png(sys.argv[2]).rows[600:]
sys.exit(sum(r > 220 and 80 < g < 130 and b < 110 for row in rows for r, g, b, a in row) < 100)
END
}

# slow.c makes files slow, which does not work together with sanitizers
[ -e "$tools/libwindow_slow.so" ] || { echo "skipped: without tests/window/slow.c"; exit 77; }
LD_PRELOAD=$tools/libwindow_slow.so start
picture new

# ---- a file that cannot be read is reported, with the panel and without it, and the document stays
drop "$files/nothing.vdb"
until_ "what is not there" said "nothing.vdb: cannot read"
shows_trouble || fail "what is not there: nothing on the screen"
key Escape
shows_trouble && fail "what was said does not go"
drop "$files/damaged.vdb"
until_ "what is damaged" said "damaged.vdb:"
key Tab
shows_trouble || fail "what is damaged: nothing on the screen without the panel"
key Tab
picture same
cmp "$work/new.png" "$work/same.png" || fail "what cannot be read changed the picture"
title_is ': new ball$' || fail "what cannot be read changed the title"
stroke 640 400 20 20

# ---- a mesh as a stamp
drop "$files/mesh.ply"
key Escape # neither
picture neither
stroke 600 380 20 20
has_events stamp 0 || fail "Escape: a stamp all the same"
drop "$files/mesh.ply"
key s
until_ "a stamp" has_events stamp 1
picture stamp
stroke 700 380 0 0
tail -5 "$journal" | grep -q '"shape":"stamp"' || fail "the stamp is not used"

# ---- with unsaved strokes, a dropped file is opened only after a question is answered
cp "$journal" "$work/kept.strokes"
sed -i 1q "$work/kept.strokes"
strokes=$(events end)
drop "$files/field.vdb"
key Escape
picture stayed
stroke 640 440 20 20
has_events end $((strokes + 1)) || fail "Escape: the session is gone"
[ -e "$vdb" ] && fail "saved without being asked to"
drop "$files/field.vdb"
key Return
opens field.vdb
[ -s "$vdb" ] || fail "opened without saving first"

# ---- without unsaved changes it is opened at once; of several files the first
drop "$work/kept.strokes" "$files/field.vdb"
until_ "strokes" title_is "kept.strokes"
drop "$files/ball.nrrd"
until_ "a volume" title_is "ball.nrrd"

# ---- dragging the isovalue; when dragging ends, the picture depends on the isovalue only, not on earlier ones
# look_at X NAME: presses the histogram at X; takes the final picture
look_at() {
    [ -z "$1" ] || xdotool mousemove "$1" 100 sleep 0.2 mousedown 1 sleep 0.2 mouseup 1 sleep 0.2
    picture "$2"
}
moved_to() { look_at "$1" "$2" && ! cmp -s "$2.png" "$3.png"; }
back_at() { look_at "$1" "$2" && cmp -s "$2.png" "$3.png"; }
look_at "" unmoved
until_ "another isovalue" moved_to 230 high unmoved
until_ "one more" moved_to 60 low high
until_ "the first one again" back_at 230 again high
drop "$files/mesh.obj" # (a volume cannot be stamped, so nothing is asked)
opens mesh.obj
drop "$files/points.ply"
key Return
until_ "points" said "points.ply:"
picture mesh
drop "$files/mesh.ply"
key Return
opens mesh.ply
picture mesh_ply # and so it is ready
stroke 480 560 20 20

# ---- strokes that were made while a file was being read are asked about when it is ready (with slow files)
for slow in first second; do
    cp "$files/mesh.obj" "$files/$slow.obj"
    touch "$files/$slow.obj.wait"
done
feed() { rm "$files/$1.wait"; }
# beside the mesh that was opened
vdb=$files/mesh.vdb
saved() { [ -s "$vdb" ]; }
# While a question is open, the mouse does not sculpt.
asked() {
    strokes=$(events end)
    drag 1 540 560 20 20
    sleep 3 # (a loaded machine is slow to take a stroke)
    has_events end "$strokes"
}
stays() { key Escape && drag 1 540 560 20 20 && [ "$(events end)" -gt "$strokes" ]; }
key ctrl+s
until_ "a save" saved
picture saved # and so the program knows
rm "$vdb"
drop "$files/first.obj"
key Return # to sculpt it
picture opening # and so the question is gone
stroke 520 560 20 20
feed first.obj
until_ "a question about a stroke" asked
until_ "Escape to keep the session" stays
saved && fail "Escape saves"
drop "$files/second.obj"
key Return # to sculpt it
key Return # to save first
until_ "a save before it is opened" saved
rm "$vdb"
picture opening
stroke 560 560 20 20
before=$journal
feed second.obj
answers() { key Return && [ -s "$vdb" ]; }
until_ "a question about one more" answers
journal=$before
opens second.obj
picture slow # and so it is ready
stroke 480 560 20 20

# ---- a save that fails leaves the existing file unchanged
vdb=$files/second.vdb
mkdir -p "$vdb/full" "$vdb.bak/full"
strokes=$(events end)
drop "$files/field.vdb"
key Return
until_ "a failed save" said "Not saved"
picture failed
stroke 480 600 20 20
has_events end $((strokes + 1)) || fail "a failed save: the session is gone"
echo "passed"
