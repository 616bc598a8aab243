# Shared by the tests of windows: starts a display and a program in it. To be sourced by bash scripts whose arguments are the
# folder of the programs, which becomes $bin, and that of the tests' own programs, which becomes $tools.
#
# All functions wait for a condition, for at most LIMIT seconds, and never for a fixed time.
LIMIT=100
bin=$(cd "$1" && pwd)
tools=$(realpath -m "${2:-.}")

for tool in Xvfb xdotool; do
    command -v $tool >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
here=$(cd "$(dirname "$0")" && pwd)
volumes=$(cd "$here/../../volumes" && pwd)
work=$(mktemp -d)
export XDG_STATE_HOME=$work/state HOME=$work LC_ALL=C
unset WAYLAND_DISPLAY
state=$XDG_STATE_HOME/isopoint
program= closing= server=
trap 'kill -9 $program $closing $server 2>/dev/null; wait 2>/dev/null; rm -rf "$work"' EXIT

fail() {
    echo "FAILED: $*"
    echo "--- what the program said:"
    cat "$work/said"
    echo "--- journals:"
    for file in "$state"/*.strokes; do cut -c1-100 "$file" | tail -5; done
    exit 1
}

# require_window: ends the test as skipped when the program was built without a window; else returns the exit status of the
# program without a display, and what it said is in $work/said
require_window() {
    local status
    env -u DISPLAY "$bin/isosculpt" 2>"$work/said"
    status=$?
    if grep -q "built without GLFW" "$work/said"; then echo "skipped: built without a window"; exit 77; fi
    return $status
}

# require_clipboard: ends the test as skipped when the tests' program that reads the clipboard was not built.
require_clipboard() {
    [ -x "$tools/window_clipboard" ] || { echo "skipped: built without X11"; exit 77; }
}

# until TEXT COMMAND: until the command succeeds
until_() {
    local what=$1 end=$((SECONDS + LIMIT))
    shift
    until "$@"; do
        [ $SECONDS -lt $end ] || fail "$what: not within $LIMIT s"
        [ -z "$program" ] || kill -0 "$program" 2>/dev/null || fail "$what: the program has ended"
        sleep 0.05
    done
}

# Starts a display that is not reset when its last client disconnects.
open_display() {
    mkfifo "$work/number"
    Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp -noreset 3>"$work/number" >/dev/null 2>&1 &
    server=$!
    read -r -t "$LIMIT" number <"$work/number" || fail "Xvfb does not start"
    export DISPLAY=:$number
}

start() {
    "$bin/isosculpt" "$@" >"$work/said" 2>&1 &
    program=$!
    until_ "a window" window_is_there
    until_ "a journal" journal_is_there
}
window_is_there() { xdotool search --onlyvisible --name '^isosculpt' >/dev/null 2>&1; }
newest() { ls -t "$state"/*.strokes 2>/dev/null | head -1; }
journal_is_there() { journal=$(newest) && [ -n "$journal" ]; }
events() { grep -c "\"event\":\"$1\"" "$journal"; }
has_events() { [ "$(events "$1")" -eq "$2" ]; }
window_number() { xdotool search --onlyvisible --name '^isosculpt' | head -1; }
title_is() { xdotool search --onlyvisible --name "$1" >/dev/null 2>&1; }
key() { xdotool key "$@"; }
# The panel takes this many columns of the window; the picture is right of it.
PANEL=304
# drag BUTTON X Y DX DY: drags the mouse in ten steps; 640, 400 is the middle of the picture beside the panel
drag() {
    local moves=() step x=$(($2 + PANEL / 2))
    for step in 1 2 3 4 5 6 7 8 9 10; do
        moves+=(mousemove $((x + $4 * step / 10)) $(($3 + $5 * step / 10)))
    done
    xdotool mousemove "$x" "$3" mousedown "$1" "${moves[@]}" mouseup "$1"
}
# stroke X Y DX DY: drags with the left button, and waits for the stroke's end in the journal
stroke() {
    local ends
    ends=$(events end)
    drag 1 "$@"
    until_ "the end of a stroke at $1,$2" has_events end $((ends + 1))
}
has_ended() { ! kill -0 "$1" 2>/dev/null; }
tools() { grep -o '"tool":"[a-z-]*"' "$journal" | cut -d'"' -f4 | tr '\n' ' '; }
# stop: kills the program, to simulate a power cut
stop() {
    kill -9 "$program"
    wait "$program" 2>/dev/null
    program=
}
# press X Y: presses a button of the panel. Dear ImGui reads the pointer's position when a picture is drawn: on a slow machine
# the button is pressed again until the expected condition is true.
press() { xdotool mousemove "$1" "$2" sleep 0.2 mousedown 1 sleep 0.2 mouseup 1 sleep 0.2; }
# shot: sets $shot to the path of the picture that F12 wrote to the folder of the saved file or of the volume
shot() { shot=$(find "$work" -maxdepth 2 -name '*-[0-9]*.png' -size +0 | head -1) && [ -n "$shot" ]; }
# picture NAME [KEY]: presses F12 (or KEY) and moves the new picture to NAME
picture() {
    key "${2:-F12}"
    until_ "picture $1" shot
    mv "$shot" "$work/$1.png"
}
# whole_window NAME: takes a picture of the whole window, with the panel
whole_window() { picture "$1" shift+F12; }
differ() { ! cmp -s "$work/$1.png" "$work/$2.png"; }
# the file to which a new ball is saved
vdb=$work/sculpture.vdb
# anew: removes all files of earlier tests
anew() { rm -rf "$state" "$work"/sculpture*; }
# window_program ARGUMENTS: starts the program without waiting for a journal, which volumes do not have
window_program() {
    "$bin/isosculpt" "$@" >"$work/said" 2>&1 &
    program=$!
    until_ "a window" window_is_there
}
# look ...: answers a question about a picture (look.py)
look() { python3 "$here/look.py" "$@"; }
# option PICTURE NAME: the option's value in the picture's scene
option() {
    "$bin/isorender" --again "$1.png" --save-scene "$1.json" -o again.png --quiet
    sed -n "s/^ *\"$2\": \"\{0,1\}\([^\"]*\).*/\1/p" "$1.json" | head -1
}
# redrawn PICTURE [N]: isorender draws the picture again from the scene in it, but for N pixels
redrawn() {
    "$bin/isorender" --again "$1.png" -o again.png --quiet || fail "$1.png: its scene cannot be drawn"
    look same "$1.png" again.png "${2:-0}" || fail "$1.png: isorender draws another picture than the window's"
}
# Whether a dialog is open: the rest of the window is dark then.
is_modal() { whole_window modal && look modal "$work/modal.png"; }
is_not_modal() { ! is_modal; }
# says WORDS: whether the program printed these words to standard error
says() { grep -qF "$1" "$work/said"; }
# A mesh of a cube.
make_box() { # NAME X Y Z SIDE: a mesh
    python3 - "$@" <<'PYTHON'
import sys
name, x, y, z, side = sys.argv[1], *map(float, sys.argv[2:])
with open(name, "w") as file:
    for i in range(8):
        file.write("v %g %g %g\n" % (x + side * (i & 1), y + side * (i >> 1 & 1), z + side * (i >> 2)))
    for a, b, c, d in ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)):
        file.write("f %d %d %d\nf %d %d %d\n" % (a, b, c, a, c, d))
PYTHON
}
# copies X Y: presses the button; whether there is a new command on the clipboard, in $command
copies() {
    press "$1" "$2"
    command=$("$tools/window_clipboard") && [ "${command#isorender }" != "$command" ] && [ "$command" != "$before_command" ]
}
copy_command() {
    before_command=${command:-}
    until_ "a command on the clipboard" copies "$@"
}
# draws NAME N: fails unless the command draws the picture NAME, except for at most N pixels
draws() {
    rm -f ./*-view.png
    (PATH=$bin:$PATH && eval "$command --quiet") || fail "$command"
    mv ./*-view.png "drawn.png"
    look same "$work/$1.png" drawn.png "$2" || fail "$1: another picture is drawn by $command"
}

# whether the path of a selected stroke is drawn over the picture
has_path() { whole_window path && look color path.png 255 200 60 304,0,1280,800 20 >/dev/null; }
# click MODIFIER X Y: a click on the picture without motion, as `stroke` counts X
click() { xdotool mousemove $(($2 + PANEL / 2)) "$3" sleep 0.1 keydown "$1" mousedown 1 sleep 0.1 mouseup 1 keyup "$1" sleep 0.1; }
# last EVENT: the journal's last one of a kind
last() { grep "\"event\":\"$1\"" "$journal" | tail -1; }
# is_same_field NAME: whether this is the saved sculpture (a file of OpenVDB begins with a number of its own)
is_same_field() { cmp -s <(tail -c +60 sculpture.vdb) <(tail -c +60 "$1"); }
