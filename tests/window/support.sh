# What the tests of windows share: a display of their own, and a program in it. For bash, which has set $bin (the
# folder of the programs), and $tools (that of the tests' own).
#
# Waits for what should happen, for as long as LIMIT seconds; never for a time.
LIMIT=100

for tool in Xvfb xdotool; do
    command -v $tool >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
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

# A display, which does not begin anew when its last client leaves.
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
# drag BUTTON X Y DX DY: in ten steps
drag() {
    local moves=() step
    for step in 1 2 3 4 5 6 7 8 9 10; do
        moves+=(mousemove $(($2 + $4 * step / 10)) $(($3 + $5 * step / 10)))
    done
    xdotool mousemove "$2" "$3" mousedown "$1" "${moves[@]}" mouseup "$1"
}
# stroke X Y DX DY: and wait for its end
stroke() {
    local ends
    ends=$(events end)
    drag 1 "$@"
    until_ "the end of a stroke at $1,$2" has_events end $((ends + 1))
}
has_ended() { ! kill -0 "$1" 2>/dev/null; }
tools() { grep -o '"tool":"[a-z-]*"' "$journal" | cut -d'"' -f4 | tr '\n' ' '; }
# stop: as a power cut would
stop() {
    kill -9 "$program"
    wait "$program" 2>/dev/null
    program=
}
# picture NAME: F12 and the file that it makes
picture() {
    local count=0 file
    while [ -e "${journal%.strokes}-$((count + 1)).png" ]; do count=$((count + 1)); done
    file=${journal%.strokes}-$((count + 1)).png
    key F12
    until_ "picture $file" test -s "$file"
    cp "$file" "$work/$1.png"
}
