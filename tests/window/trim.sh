#!/bin/bash
# Trimming in a real window under Xvfb: a lasso and a line over the picture, their other sides, Escape, undo, what outlines
# nothing, and everything. trim.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77:
# skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
MIDDLE=$((640 + PANEL / 2)) # of the picture, and of the ball, in the window
# outline X Y X Y ...: drags over these places, relative to the middle; the button stays down
outline() {
    local moves=() first=1
    while [ $# -gt 1 ]; do
        moves+=(mousemove $((MIDDLE + $1)) $((400 + $2)) sleep 0.03)
        [ $first = 1 ] && moves+=(mousedown 1)
        first=0
        shift 2
    done
    xdotool "${moves[@]}"
}
# trims N X Y ...: the outline is the stroke number N
trims() {
    local wanted=$1
    shift
    outline "$@"
    xdotool mouseup 1
    until_ "the end of stroke $wanted" has_events end "$wanted"
}
# spans NAME FIRST LAST: the object in the picture NAME extends over these columns, but for two
spans() {
    read -r found_x0 _ found_x1 _ <<<"$(look box "$work/$1.png")"
    local first=$((found_x0 - $2)) last=$((found_x1 - $3))
    [ ${first#-} -le 2 ] && [ ${last#-} -le 2 ] || fail "$1: columns $found_x0 to $found_x1, not $2 to $3"
}
SQUARE="-60 -300 300 -300 300 300 -60 300"

start
key shift+1
picture ball
read -r x0 _ x1 _ <<<"$(look box "$work/ball.png")"

# ---- a lasso around the right part, which it starts and ends beside: what it touches goes
key a
trims 1 $SQUARE
picture left
spans left "$x0" $((488 - 60))
key ctrl+z
until_ "undo" has_events undo 1
picture again
cmp -s ball.png again.png || fail "undo gives another picture"

# ---- with Alt it is what is left
xdotool keydown alt
trims 2 $SQUARE
xdotool keyup alt
[ "$(tools)" = "trim-lasso crop-lasso " ] || fail "tools: $(tools)"
picture right
spans right $((488 - 60)) "$x1"
key ctrl+z
until_ "undo" has_events undo 2

# ---- a line is drawn with ticks on the side that goes: upwards the right one, downwards the left one
key b
outline 100 300 100 -300
whole_window line
look color line.png 255 190 90 "$((MIDDLE + 98)),200,$((MIDDLE + 108)),600" 200 >/dev/null || fail "no line is to be seen"
xdotool mouseup 1
until_ "a line" has_events end 3
picture lined
spans lined "$x0" $((488 + 100))
trims 4 -50 -300 -50 300
picture slice
spans slice $((488 - 50)) $((488 + 100))

# ---- a click is no stroke, and Escape takes an outline back
xdotool mousemove $MIDDLE 400 click 1
outline 0 -300 0 300
key Escape
xdotool mouseup 1
key a
xdotool mousemove $MIDDLE 400 click 1
outline 0 0 40 0 80 0
xdotool mouseup 1 # encloses nothing
until_ "a message" says "encloses nothing"
has_events end 4 || fail "what outlines nothing is a stroke"
picture unchanged
cmp -s slice.png unchanged.png || fail "what outlines nothing changes the picture"

# ---- everything: said, and undone
trims 5 -400 -350 450 -350 450 390 -400 390
until_ "a message" says "Nothing is left of the object"
key ctrl+z
until_ "undo" has_events undo 3
picture back
cmp -s slice.png back.png || fail "undo gives another picture"

# ---- the journal replays without a window to the same field
cp "$journal" trim.strokes
"$bin/isosculpt" --replay trim.strokes --headless --quiet --output one.ply --threads 1
"$bin/isosculpt" --replay trim.strokes --headless --quiet --output many.ply
cmp one.ply many.ply || fail "another number of threads gives another surface"
echo "passed"
