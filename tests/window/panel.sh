#!/bin/bash
# The panel in a real window under Xvfb: where the picture is beside it, lists and Escape, the mask's buttons and keys, fonts
# and scales, and what survives a crash. panel.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit
# status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

# middle NAME X: whether the middle of the object in the picture is at column X
middle() {
    read -r x0 y0 x1 y1 <<<"$(look box "$work/$1.png")"
    awk -v m="$((x0 + x1))" -v x="$2" 'BEGIN { exit !(m - 2 * x <= 3 && 2 * x - m <= 3) }'
}
# rest NAME: takes a picture of the whole window after it has been at rest for a while
rest() {
    xdotool sleep 2
    whole_window "$1"
}

# ---- the picture is in the middle of what the panel leaves free, of the window when it is hidden; the brush follows
start
picture beside
middle beside 488 || fail "beside the panel, the object is at $x0 .. $x1"
stroke 640 400 0 0
position=$(grep '"event":"begin"' "$journal" | grep -o '"at":[^]]*' | cut -d[ -f2)
awk -v p="$position" 'BEGIN { split(p, v, ","); exit !(v[1] > -0.3 && v[1] < 0.3 && v[3] > -0.3 && v[3] < 0.3) }' ||
    fail "a stroke in the middle of the picture is at $position"
key ctrl+z Tab
picture alone
middle alone 640 || fail "without the panel, the object is at $x0 .. $x1"
PANEL=0 stroke 640 400 0 0
position=$(grep '"event":"begin"' "$journal" | tail -1 | grep -o '"at":[^]]*' | cut -d[ -f2)
awk -v p="$position" 'BEGIN { split(p, v, ","); exit !(v[1] > -0.3 && v[1] < 0.3 && v[3] > -0.3 && v[3] < 0.3) }' ||
    fail "without the panel, a stroke in the middle of the picture is at $position"
key ctrl+z Tab
picture beside_again
cmp beside.png beside_again.png || fail "the panel hidden and shown: another picture"

# ---- edges at rest have four samples
xdotool mousemove 1270 790
rest edges
look smooth edges.png 304,150,1280,650 || fail "edges at rest are jagged"

# ---- strength acts on add: a weaker stroke builds up less
before=$(tools)
key 1
stroke 640 400 20 0
picture half
key ctrl+z
xdotool mousemove 200 217 sleep 0.2 mousedown 1 sleep 0.2 mousemove 40 217 sleep 0.2 mouseup 1 sleep 0.2
stroke 640 400 20 0
picture weak
[ "$(tools)" = "${before}add add " ] || fail "tools: $(tools)"
differ half weak || fail "strength does nothing for add"
key ctrl+z
xdotool mousemove 30 217 sleep 0.2 mousedown 1 sleep 0.2 mousemove 115 217 sleep 0.2 mouseup 1 sleep 0.2

# ---- Escape closes an open list and nothing else
xdotool mousemove 1270 790 sleep 0.3
whole_window closed
opens_list() {
    xdotool mousemove 120 "$1" sleep 0.2 mousedown 1 sleep 0.1 mouseup 1 sleep 0.3
    whole_window list
    ! look same closed.png list.png 3000 0,0,304,800 >/dev/null
}
closes_list() {
    key Escape
    xdotool mousemove 1270 790 sleep 0.3
    whole_window after
    look same closed.png after.png 100 0,0,304,800 >/dev/null
}
for row in 245 357 385; do
    until_ "a list" opens_list $row
    until_ "Escape closes the list" closes_list
done
opens_browser() { key ctrl+o && is_modal; }
until_ "the browser" opens_browser
whole_window browser
xdotool mousemove 450 523 sleep 0.2 mousedown 1 sleep 0.1 mouseup 1 sleep 0.3
whole_window types
look same browser.png types.png 3000 304,0,1280,700 >/dev/null && fail "no list of types"
key Escape
is_modal || fail "Escape in a list closes the dialog, too"
key Escape
until_ "Escape closes the dialog" is_not_modal

# ---- Enter opens a typed folder in the dialog, and a folder typed there; the mesh in it is then the only file to choose
mkdir -p shelf/inner
make_box shelf/inner/b.obj 5 5 5 10
opens_folder() {
    press 90 554
    xdotool key --delay 100 ctrl+a
    xdotool type "$1"
    xdotool sleep 0.3 key Return sleep 0.5
    is_modal
}
until_ "a folder in the dialog" opens_folder shelf
xdotool type inner/
xdotool sleep 0.3 key Return sleep 0.5 key Down sleep 0.3 key Return sleep 1
is_modal && key Return # there may be unsaved changes
opened() { head -1 "$(newest)" | grep -qF '/shelf/inner/b.obj"'; }
until_ "shelf/inner/b.obj" opened
stop
anew
start

# ---- the mask: inverted and cleared by keys and buttons, undone, and in the stroke file
picture free
key 9
stroke 640 400 20 20
picture masked
differ free masked || fail "the mask is not to be seen"
key ctrl+i
picture inverted
differ masked inverted && differ free inverted || fail "the inverted mask is not to be seen"
key 2
stroke 560 300 10 10 # in the frozen part
picture frozen
cmp inverted.png frozen.png || fail "what an inverted mask freezes was carved" # (and so there is nothing to undo)
inverts() { press 72 301; picture twice; ! differ masked twice; }
key ctrl+z
picture undone
cmp masked.png undone.png || fail "undo of an inverted mask"
key alt+m
picture cleared
cmp free.png cleared.png || fail "a cleared mask is to be seen"
key ctrl+z ctrl+i
picture inverted_again
cmp inverted.png inverted_again.png || fail "inverted again: another picture"
until_ "the button that inverts" inverts
clears() { press 157 301; picture none; ! differ free none; }
until_ "the button that clears" clears
tools | grep -q "invert-mask .*clear-mask .*invert-mask .*clear-mask " || fail "the mask in the stroke file: $(tools)"
"$bin/isosculpt" --replay "$journal" --headless --quiet --json=replay.json || fail "strokes that change the mask do not play"

# ---- the title: the name of the file, with * after unsaved changes
until_ "a title with *" title_is ': new ball\*$'
key ctrl+s
until_ "sculpture.vdb" test -s sculpture.vdb
until_ "the title of the saved file" title_is ': sculpture.vdb$'
stroke 640 400 20 20
until_ "unsaved changes in the title" title_is ': sculpture.vdb\*$'

# ---- killed and recovered: method, light, tool and symmetry are as before, and so is the file to save to
key 3
key m
chooses_light() { # the third one of the list
    press 120 385
    press 60 454
    grep -q 'light=matcap pearl' "$journal.open"
}
until_ "another light" chooses_light
symmetric() { press 72 273; whole_window mirror; look color mirror.png 255 120 110 320,0,1280,800 100; }
until_ "a mirror" symmetric
key f
picture look
kill -9 "$program"
wait "$program" 2>/dev/null
start --recover
until_ "the title of the recovered file" title_is ': sculpture.vdb\*$'
key f
picture look_again
look same look.png look_again.png 500 || fail "recovered: another picture" # (single pixels depend on the order of points)
stroke 700 400 10 10
grep '"event":"begin"' "$journal" | tail -1 >begin
grep -q '"tool":"blend-add".*"symmetry":1,' begin || fail "recovered: another brush: $(cut -c1-300 begin)"
stop

# ---- the built-in font: rows are where they are with every other font; a file that is no font is refused
anew
start --font builtin
carves() {
    press 152 50
    stroke 640 400 10 10
    [ "$(tools | awk '{ print $NF }')" = carve ]
}
until_ "the built-in font: carving" carves
stop
echo "no font" >text.ttf
for font in text.ttf missing.ttf; do
    "$bin/isosculpt" --font $font 2>said
    code=$?
    [ $code -eq 3 ] && [ "$(wc -l <said)" -eq 1 ] && grep -q $font said || fail "--font $font: exit status $code, $(cat said)"
done

# ---- text and panel half as large again
anew
start --scale 1.5
PANEL=456
carves() {
    press 228 75
    stroke 640 400 10 10
    [ "$(tools | awk '{ print $NF }')" = carve ]
}
until_ "scale 1.5: carving" carves
stop
echo "passed"
