#!/bin/bash
# The reference in a real window under Xvfb: the surface as it was when the session began, as an x-ray of the sculpture.
# reference.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped, as something
# needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

# slide X Y DX: drags in the panel, slowly enough that its frames see it
slide() {
    xdotool mousemove "$1" "$2" sleep 0.2 mousedown 1 sleep 0.2 mousemove $(($1 + $3 / 2)) "$2" sleep 0.2 \
        mousemove $(($1 + $3)) "$2" sleep 0.2 mouseup 1 sleep 0.2
}

# ---- what was carved away is seen
start
key 2 r
stroke 640 400 40 30
shows() {
    picture carved
    key r
    picture plain
    key r
    differ carved plain
}
until_ "what was carved away, as an x-ray" shows
first=$(grep '"event":"begin"' "$journal" | tail -1 | grep -o '"at":[^]]*')

# ---- picks do not know the reference: the same stroke without it begins at the same place
key r ctrl+z
stroke 640 400 40 30
picture plain_again
cmp plain.png plain_again.png || fail "with the reference, a stroke does something else"
[ "$(grep '"event":"begin"' "$journal" | tail -1 | grep -o '"at":[^]]*')" = "$first" ] || fail "a stroke begins elsewhere"
key r
picture carved_again
cmp carved.png carved_again.png || fail "the reference is another one"

# ---- its opacity; seen through the sculpture; another camera and back; undone
fainter() {
    slide 166 526 -30
    picture fainter
    differ fainter carved
}
until_ "a fainter reference" fainter
through() {
    press 62 526
    press 50 575
    picture through
    differ through fainter
}
until_ "the reference through the sculpture" through
drag 2 640 400 40 0
picture turned
differ turned through || fail "the camera does not move"
key Ctrl+3 Shift+1
picture through_front
key Ctrl+3 Shift+1
picture through_again
cmp through_front.png through_again.png || fail "the reference depends on where the camera was"
key ctrl+z r shift+1
picture undone
key r
picture undone_through
differ undone undone_through || fail "the reference is not seen through an unchanged sculpture"
stop

# ---- a reference that cannot be made is said: the file that the session began with is gone
"$bin/isosculpt" --replay "$journal" --headless --quiet --output "$work/opened.vdb" ||
    { echo "skipped: built without OpenVDB"; exit 77; }
anew
start "$work/opened.vdb"
rm "$work/opened.vdb"
picture gone
key r
until_ "a message" says "No reference: "
picture still_gone
cmp gone.png still_gone.png || fail "without a reference the picture changes"
stroke 640 400 10 10
stop

# ---- chosen on the command line
anew
start --x-ray over
key 2
stroke 640 400 40 30
picture over
key r
picture without
differ over without || fail "--x-ray over shows nothing"
stop

# ---- lines and glyphs of files: shown from the start, hidden by R, hidden by the sculpture until it is carved away
anew
printf '1 1 -90 0 20 3 -1\n2 1 90 0 20 3 1\n' >line.swc
start --reference line.swc
shows_files() {
    picture files
    key r
    picture none
    key r
    differ files none
}
until_ "lines beside the sculpture" shows_files
radius=$(grep -o '"radius":[0-9.]*' "$journal" | head -1 | cut -d: -f2)
stop
anew
echo "x,y,z,radius
0,0,0,$(python3 -c "print($radius - 1)")" >ball.csv # in the ball that a session begins with
start --reference ball.csv
picture hidden
key r
picture without
look near "$work/hidden.png" "$work/without.png" 1 || fail "a glyph in the sculpture is seen"
key r 2
stroke 640 400 40 30
finds_ball() {
    picture found
    key r
    picture missed
    key r
    differ found missed
}
until_ "a glyph where the sculpture was carved away" finds_ball
stop
printf '1 1 9000 0 0 3 -1\n2 1 9090 0 0 3 1\n' >far.swc
anew
start --reference far.swc
until_ "a note" says "far.swc lies beside the rest"
stop
echo "passed"
