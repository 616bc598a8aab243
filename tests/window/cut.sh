#!/bin/bash
# A plane that cuts, in a real window under Xvfb: dragged and tilted by its handle, with caps; occlusion and looks of the
# picture at rest; cuts of a scene. What is shown is what isorender draws again from the picture's scene, to the same pixels.
# cut.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
cp "$volumes/stent.nrrd" stent.nrrd

# ---- K puts a plane through the middle, which faces the eye; its cap has the surface's colour
window_program stent.nrrd --isovalue 300
until_ "the volume" title_is 'stent.nrrd'
picture whole
key k
is_cut() { picture cut && differ whole cut; }
until_ "a cut" is_cut
redrawn cut
[ "$(option cut cap)" = surface ] || fail "no cap"
[ "$(option cut clip | cut -d: -f2)" = 0,-1,0 ] || fail "the plane does not face the eye"

# ---- its handle, in the middle of the picture, is dragged upwards: the plane follows at once, away from the eye
at() { option "$1" clip | cut -d: -f1 | cut -d, -f2; }
xdotool mousemove 792 400 sleep 0.2 mousedown 1 mousemove 792 390 mousemove 792 380
live() { whole_window live && picture live && differ cut live; }
until_ "a plane that moves while it is dragged" live
xdotool mousemove 792 370 mouseup 1
moved() { picture moved && differ live moved; }
until_ "the plane moved" moved
redrawn moved
awk -v a="$(at cut)" -v b="$(at live)" -v c="$(at moved)" 'BEGIN { exit !(a < b && b < c) }' ||
    fail "the plane moved from $(at cut) to $(at live) and $(at moved)"
[ "$(option moved clip | cut -d: -f2)" = 0,-1,0 ] || fail "the plane was turned, not moved"
[ "$(option moved camera-position)" = "$(option cut camera-position)" ] || fail "the camera moved with the plane"

# ---- with Shift it is tilted about its handle
keydown() { xdotool keydown shift; drag 1 640 400 -60 0; xdotool keyup shift; }
keydown
tilted() { picture tilted && differ moved tilted; }
until_ "the plane tilted" tilted
redrawn tilted
[ "$(option tilted clip | cut -d: -f1)" = "$(option moved clip | cut -d: -f1)" ] || fail "the tilted plane was moved"
awk -F'[:,]' '{ exit !($4 < -0.3 && $5 < -0.5) }' <<<"$(option tilted clip)" || fail "it was tilted to $(option tilted clip)"
whole_window handle

# ---- the panel: caps that show the volume
press 60 589
section() { whole_window section && differ handle section; }
until_ "the panel's section" section
press 110 673
press 52 763
sliced() { picture sliced && [ "$(option sliced cap)" = slice ]; }
until_ "a cap that shows the volume" sliced
redrawn sliced
differ sliced tilted || fail "the volume is not shown"

# ---- O: occlusion, at rest
key o
lit() { picture lit && differ lit sliced; }
until_ "occlusion" lit
redrawn lit

# ---- the look for figures on white paper, with outlines
press 110 786
press 48 697
paper() { picture paper && [ "$(option paper background)" = FFFFFF ]; }
until_ "the look for paper" paper
redrawn paper
[ "$(option paper outline)" = 1 ] || fail "the look for paper has no outlines"

# ---- K again: nothing is cut
key k
uncut() { picture uncut && [ -z "$(option uncut clip)" ]; }
until_ "no cut" uncut
redrawn uncut
stop

# ---- the picture opens as it was shown; so does a scene with cuts of all kinds, two surfaces, and a cap
window_program paper.png
until_ "the picture's volume" title_is 'stent.nrrd'
picture opened
look same paper.png opened.png 0 || fail "the picture is opened in another way"
stop
"$bin/isorender" stent.nrrd --isovalue 200,700 --opacity 0.4,1 --color CC8866,EEEEDD --background 2E3238 --clip box:0,0,100,64,128,160@1 \
    --clip 'keep:sphere:64,64,128,90' --clip '64,64,128:1,1,0@1' --cap slice:viridis --window 500,900 --azimuth 20 \
    --resolution 976x800 --samples 4 --output scene.png --save-scene figure.json --quiet || fail "isorender saves no scene"
window_program figure.json
until_ "the scene's volume" title_is 'stent.nrrd'
picture scene_opened
look same scene.png scene_opened.png 0 || fail "the scene is opened as another picture"
redrawn scene_opened
for name in clip cap window opacity; do
    [ "$(option scene_opened $name)" = "$(option scene $name)" ] || fail "--$name of the scene is $(option scene_opened $name)"
done

# ---- what is opaque is lit beside a translucent surface, too
key o
skin_lit() { picture skin_lit && differ skin_lit scene_opened; }
until_ "occlusion of the opaque surface" skin_lit
redrawn skin_lit
stop

# ---- a plane through the middle is in the middle of the volume, not of the surface
"$bin/isorender" stent.nrrd --isovalue 700 --color CC8866 --background 2E3238 --clip axial --cap surface \
    --resolution 976x800 --samples 4 --output axial.png --save-scene axial.json --quiet || fail "isorender saves no scene"
window_program axial.json
until_ "the scene's volume" title_is 'stent.nrrd'
picture axial_opened
look same axial.png axial_opened.png 0 || fail "the middle is another one in the window"
stop

# ---- what a window does not show is said, and what is no cut is refused
"$bin/isorender" stent.nrrd --isovalue 300 --slice z=20 --output slice.png --save-scene slice.json --quiet || fail "no scene"
window_program slice.json
until_ "the scene's volume" title_is 'stent.nrrd'
whole_window message
look color message.png 184 189 196 304,700,1280,800 60 >/dev/null || fail "it is not said what is left out"
stop

# ---- a sculpture is cut, too: where it is open, a brush works on what is in it
start
key k
ball() { whole_window ball && look color ball.png 255 190 90 700,300,900,500 60 >/dev/null; }
until_ "the plane of a ball" ball
stroke 600 340 40 0
[ "$(tools)" = "add " ] || fail "the brush on a cap: $(tools)"
stop
echo "passed"
