#!/bin/bash
# See-through pictures in a real window under Xvfb: the opacity of a volume's surface, a second isovalue in its histogram,
# and the reference of the field that is made of it.
# see_through.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped, as something
# needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_clipboard
require_window
open_display
cd "$work" || exit 1
cp "$volumes/stent.nrrd" "$work/stent.nrrd"

# slide X Y DX: drags in the panel, slowly enough that its frames see it
slide() {
    xdotool mousemove "$1" "$2" sleep 0.2 mousedown 1 sleep 0.2 mousemove $(($1 + $3 / 2)) "$2" sleep 0.2 \
        mousemove $(($1 + $3)) "$2" sleep 0.2 mouseup 1 sleep 0.2
}
# the values in the command that draws the picture; the button is lower when there is a second isovalue
command_of() {
    before_command=
    command=
    until_ "a command on the clipboard" copies 105 "$1"
}
isovalues() { grep -o -- '--isovalue=[^ ]*' <<<"$command" | cut -d= -f2; }
opacities() { grep -o -- '--opacity=[^ ]*' <<<"$command" | cut -d= -f2; }

# ---- opacity: what is drawn by the command is what the window shows, at rest
window_program stent.nrrd --isovalue 600
until_ "the volume" title_is 'stent.nrrd'
picture opaque
translucent() {
    slide 208 233 -120
    picture translucent
    differ opaque translucent
}
until_ "a translucent surface" translucent
command_of 457
awk -v a="$(opacities)" 'BEGIN { exit !(a > 0.2 && a < 0.6) }' || fail "the opacity is $(opacities)"
draws translucent 0

# ---- a second isovalue
two() {
    press 23 261
    whole_window two
    look color two.png 240 143 219 12,38,292,150 60
}
until_ "a second line in the histogram" two
command_of 513
second=$(isovalues | cut -d, -f2)
awk -v a="$second" 'BEGIN { exit !(a > 600) }' || fail "isovalues $(isovalues)"
picture second
draws second 0
differ second translucent || fail "a second isovalue is not to be seen"

# ---- its line is dragged, and the first one stays; then the first one, and the second one stays
line=$(awk -v v="$second" 'BEGIN { printf "%d", 12 + 280 * (v - 62) / 1938 }')
second_moves() {
    slide "$line" 100 20
    command_of 513
    [ "$(isovalues | cut -d, -f1)" = 600 ] && [ "$(isovalues | cut -d, -f2)" != "$second" ]
}
until_ "the second isovalue dragged" second_moves
second=$(isovalues | cut -d, -f2)
first_moves() {
    slide 90 100 -20
    command_of 513
    [ "$(isovalues | cut -d, -f2)" = "$second" ] && [ "$(isovalues | cut -d, -f1)" != 600 ]
}
until_ "the first isovalue dragged" first_moves
picture dragged
draws dragged 0

# ---- both are opaque
both() {
    slide 120 233 100
    command_of 513
    [ -z "$(opacities)" ]
}
until_ "two opaque surfaces" both
picture both
draws both 0

# ---- a brush is chosen: the first surface becomes a field, and is opaque
# (the panel names the journal as soon as the window shows the field: until then F12 takes a picture of the volume)
key 2
sculpting() {
    whole_window sculpting
    look color sculpting.png 150 208 150 8,616,240,638 50
}
until_ "a field" sculpting
until_ "its journal" journal_is_there
picture field

# ---- the reference: nothing of it lies in front of what was not changed (samples are rounded before they are averaged)
key r
referenced() {
    whole_window panel
    look color panel.png 130 190 240 254,516,294,538 50
}
until_ "the reference's colour in the panel" referenced
picture unchanged
look near field.png unchanged.png 1 || fail "the reference is seen in front of an unchanged sculpture"
stop
echo "passed"
