#!/bin/bash
# The path of a selected stroke dragged by its handles, groups of strokes and reseating, in a real window under Xvfb: the saved
# sculpture is, byte for byte, what the journal gives without a window. handles.sh BIN TOOLS: the folders of the programs and of
# the tests' own programs. Exit status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

start
stroke 560 300 60 10
stroke 640 400 60 10
stroke 720 520 20 0
picture drawn
# the sections above fold, so that the one of strokes is in the window
press 60 330
press 60 358
lists() { whole_window list && { look color list.png 230 233 238 34,618,44,632 4 >/dev/null || { press 60 571; false; }; }; }
until_ "the section of strokes" lists

# ---- a handle: the path follows at once, the surface when the edit is drawn; no stroke is made
click alt 695 409
until_ "the path of a stroke" has_path
picture selected
x=$((640 + PANEL / 2))
xdotool mousemove $x 400 sleep 0.2 mousedown 1 mousemove $((x - 20)) 430 sleep 0.2 mousemove $((x - 40)) 460 sleep 0.3
outline() { whole_window bent && look color bent.png 255 255 255 $((x - 46)),454,$((x - 34)),466 20 >/dev/null; }
until_ "the outline" outline
has_events path 0 || fail "a path before the button is released"
xdotool mouseup 1
until_ "a path" has_events path 1
last path | grep -q '"stroke":2,"path":\[\[' || fail "path: $(last path | cut -c1-200)"
has_events begin 3 || fail "a handle draws a stroke"
until_ "the edit" eval 'picture bent && differ selected bent'
# Escape lets go of it
xdotool mousemove $((x - 40)) 460 sleep 0.2 mousedown 1 mousemove $x 300 sleep 0.2 key Escape sleep 0.2 mouseup 1 sleep 0.2
picture same
cmp bent.png same.png || fail "Escape while a handle is dragged: another picture"
has_events path 1 || fail "Escape while a handle is dragged makes an edit"
has_path || fail "Escape while a handle is dragged selects nothing"
key ctrl+z
until_ "undo" has_events undo 1
picture undone
cmp selected.png undone.png || fail "undo of a path: another picture"
key ctrl+shift+z
until_ "redo" has_events redo 1
picture redone
cmp bent.png redone.png || fail "redo of a path: another picture"

# ---- strokes 2 and 3 become a group: two rows are selected, and its name is typed
# (a single selected stroke is named above its brush, which moves the list down by a row)
named() {
    key Escape Escape
    xdotool sleep 0.3
    press 100 605
    xdotool keydown shift sleep 0.1
    press 100 653
    xdotool keyup shift sleep 0.1
    xdotool mousemove 100 760 sleep 0.3 click 1 sleep 0.3
    xdotool key --delay 80 ctrl+a e a r s Return sleep 0.3
    has_events group 1
}
until_ "a group" named
last group | grep -q '"stroke":2,"last":3,"group":"ears"' || fail "group: $(last group)"
key Escape Escape
picture grouped
# folded: the first stroke moves up to the second row, and the third is empty
folds() {
    whole_window list
    look color list.png 230 233 238 24,616,150,636 8 >/dev/null && ! look color list.png 230 233 238 24,638,150,700 1 >/dev/null && return
    press 61 605
    false
}
until_ "a folded group" folds
# its eye leaves both strokes out, as one step
mutes() { press 34 605 && xdotool sleep 0.5 && has_events mute 1; }
until_ "the eye of a group" mutes
last mute | grep -q '"group":"ears","crc"' || fail "mute: $(last mute)"
until_ "the muted group" eval 'picture muted && differ grouped muted'
key ctrl+z
until_ "undo of the group" eval 'picture back && cmp -s grouped.png back.png'
# it is dragged below the first stroke
moves() {
    xdotool mousemove 120 605 sleep 0.2 mousedown 1 sleep 0.2 mousemove 120 612 sleep 0.2 mousemove 120 620 sleep 0.2 \
        mousemove 120 625 sleep 0.2 mouseup 1 sleep 0.2
    has_events move 1
}
until_ "a group that is dragged" moves
last move | grep -q '"group":"ears","before":1,"crc"' || fail "move: $(last move)"

# ---- the first stroke is the last now, and is reseated: what lies under it has come since
reseats() { key Escape Escape; press 100 605; press 258 760; xdotool sleep 0.5; has_events reseat 1; }
until_ "a reseat" reseats
last reseat | grep -q '"stroke":1,"path":\[\[' || fail "reseat: $(last reseat | cut -c1-200)"

# ---- what is saved is what the journal gives without a window
key ctrl+s
until_ "sculpture.vdb" test -s sculpture.vdb
until_ "the title of the saved file" title_is ': sculpture.vdb$'
cp "$journal" base.strokes
"$bin/isosculpt" --replay base.strokes --headless --quiet --output journal.vdb || fail "the journal cannot be played"
is_same_field journal.vdb || fail "the journal gives another sculpture"
echo "passed"
