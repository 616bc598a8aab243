#!/bin/bash
# Saving in a real window under Xvfb: to which file, in which format, questions before overwriting, and the file browser.
# saving.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped, as something
# needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
make_box "$work/box.obj" 0 0 0 20
"$bin/isosculpt" --open "$work/box.obj" --headless --quiet --output "$work/probe.vdb" || { echo "skipped: built without OpenVDB"; exit 77; }
open_display
cd "$work" || exit 1

opens_browser() { # by KEY, or by pressing the button at X Y
    if [ $# -eq 1 ]; then key "$1"; else press "$@"; fi
    is_modal
}
# enter TEXT: types it into the browser's text box
enter() {
    xdotool key --delay 50 ctrl+a
    xdotool type --delay 30 "$1"
    xdotool sleep 0.3 key Return
}
save_as() {
    until_ "the browser" opens_browser ctrl+shift+s
    enter "$1"
}
export_as() {
    until_ "the browser" opens_browser 181 582
    enter "$1"
}
is_stl() { # whole: as long as its number of triangles says
    [ -s "$1" ] && python3 - "$1" <<'PYTHON'
import os, struct, sys
with open(sys.argv[1], "rb") as file:
    count, = struct.unpack("<I", file.read(84)[80:])
sys.exit(not (count > 100 and os.path.getsize(sys.argv[1]) == 84 + 50 * count))
PYTHON
}
is_obj() { [ -s "$1" ] && grep -q "^f " "$1"; }
is_ply_mesh() { [ -s "$1" ] && head -c 600 "$1" | grep -aq "element face"; }
is_vdb() { [ -s "$1" ] && head -c 4 "$1" | cmp -s - <(printf ' BDV'); }

start
picture new
stroke 640 400 20 20

# ---- save: a new ball is saved in the working directory; a second time to the same file, without a question
key ctrl+s
until_ "sculpture.vdb" is_vdb sculpture.vdb
stroke 600 420 20 20
key ctrl+s
until_ "the file before" test -s sculpture.vdb.bak
ls "$state" | grep -q vdb && fail "saved among the journals"

# ---- save as: the format follows the extension; later saves go to this file
save_as my.stl
until_ "my.stl" is_stl my.stl
[ ! -e "$state/my.vdb" ] && [ ! -e my.vdb ] || fail "my.stl was saved as .vdb"
cp my.stl before.stl
stroke 680 420 20 20
key ctrl+s
again() { is_stl my.stl && ! cmp -s my.stl before.stl; }
until_ "my.stl again" again
save_as whole # no extension: that of the type
until_ "whole.stl" is_stl whole.stl

# ---- export: writes a copy; later saves go to the same file as before
for name in copy.obj copy.ply copy.vdb sub/dir.stl; do
    [ "$name" = sub/dir.stl ] && mkdir sub
    export_as "$name"
    until_ "$name" test -s "$name"
done
is_obj copy.obj || fail "copy.obj is no mesh"
is_ply_mesh copy.ply || fail "copy.ply is no mesh"
is_vdb copy.vdb || fail "copy.vdb is no level set"
is_stl sub/dir.stl || fail "sub/dir.stl is no mesh"
"$bin/isorender" copy.vdb copy.png --resolution 64x64 --quiet || fail "copy.vdb cannot be drawn"
rm copy.png whole.stl.bak 2>/dev/null
key ctrl+s
until_ "whole.stl again" test -s whole.stl.bak

# ---- a name with another extension: nothing is written
save_as my.step
until_ "a name that says nothing" says "my.step: the name must end in"
[ ! -e my.step ] || fail "my.step was written"
key Escape

# ---- before an existing file is overwritten there is a question; with "no" the file is kept
echo "not mine" >kept.stl
save_as kept.stl
until_ "a question" is_modal
key Escape
until_ "no question" is_not_modal
echo "not mine" | cmp -s - kept.stl || fail "Escape: kept.stl was written over"
stroke 640 440 20 20 # the session goes on
save_as kept.stl
until_ "a question" is_modal
key Return
until_ "kept.stl" is_stl kept.stl
echo "not mine" | cmp -s - kept.stl.bak || fail "kept.stl is lost"
mkdir folder.vdb
save_as folder.vdb # enters it, and shows it a few pictures later
xdotool sleep 2
enter inside.vdb
until_ "folder.vdb/inside.vdb" is_vdb folder.vdb/inside.vdb

# ---- saving while closing writes to the file that the panel shows
stroke 600 440 20 20
rm folder.vdb/inside.vdb
key ctrl+q
until_ "a question" is_modal
key Return
closing=$program
program=
until_ "closing" has_ended "$closing"
is_vdb folder.vdb/inside.vdb || fail "closing did not save"

# ---- the file that a session began with is never overwritten; another name in its folder is used
anew
cp box.obj before.obj
echo "somebody's" >box.vdb
start "$work/box.obj"
until_ "its title" title_is ': box.obj$'
picture box
stroke 640 400 20 20
save_as box.obj
until_ "a refusal" says "box.obj: this session began with that file"
cmp -s box.obj before.obj || fail "the opened mesh was written over"
key Escape
key ctrl+s
until_ "box-2.vdb" is_vdb box-2.vdb
echo "somebody's" | cmp -s - box.vdb || fail "box.vdb was written over"
ln -s box.obj link.obj # another name of it
save_as link.obj
until_ "a refusal" says "link.obj: this session began with that file"
cmp -s box.obj before.obj || fail "the opened mesh was written over through a link"
key Escape

# ---- pictures: in the folder of the saved file, or under a chosen name
key F12
until_ "a picture beside it" test -s "$work/box-2-1.png"
rm box-2-1.png
until_ "the browser" opens_browser 249 470
enter portrait.png
until_ "portrait.png" test -s portrait.png

# ---- the browser: folders, types, hidden files, keys; Down selects the first file, which is opened
mkdir -p shelf/inner
make_box shelf/inner/b.obj 5 5 5 10
make_box shelf/inner/.a.obj 5 5 5 10
cp shelf/inner/b.obj shelf/inner/a.txt
before=$(newest)
until_ "the browser" opens_browser ctrl+o
enter shelf
xdotool sleep 0.5 key Down sleep 0.3 key Return sleep 0.5 key Down sleep 0.3
whole_window browser
key Return
opened() { [ "$(newest)" != "$before" ] && head -1 "$(newest)" | grep -qF '/shelf/inner/b.obj"'; }
until_ "shelf/inner/b.obj" opened
stop

# ---- a sculpture of which nothing is left is saved, and the window says so
anew
make_box small.obj 0 0 0 20
start "$work/small.obj" --voxel-size 4
picture small
key 2
stroke 640 400 8 8
key ctrl+s
until_ "small.vdb" is_vdb small.vdb
until_ "the words about it" says "small.vdb: nothing is left of the solid"
stop

# ---- a viewed volume can be saved, too: its surface becomes a field; the title follows the file
anew
cp "$volumes/stent.nrrd" ct.nrrd
window_program ct.nrrd --isovalue 600
until_ "the volume" title_is ': ct.nrrd$'
picture volume
key ctrl+s
until_ "ct.vdb" is_vdb ct.vdb
until_ "the title of the saved file" title_is ': ct.vdb$'
journal_is_there || fail "a volume was saved without becoming a field"
echo "passed"
