#!/bin/bash
# Scenes in isosculpt's window: F12's picture holds one, which isorender draws again to the same pixels; a scene of
# isorender, and a picture that holds one, open as they were shown.
# scenes.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
cp "$volumes/stent.nrrd" "$work/stent.nrrd"

# ---- a scene of isorender, with a camera, a colour and a part of the volume
"$bin/isorender" stent.nrrd --isovalue 600 --azimuth 40 --elevation 20 --color 4477AA --background FFEEDD --crop 20,110,10,110,0,255 \
    --save-scene figure.json --quiet || fail "isorender saves no scene"
window_program figure.json
until_ "the scene's volume" title_is 'stent.nrrd'
picture first
look color first.png 255 238 221 0,0,40,40 1500 >/dev/null || fail "the scene's background is not shown"
"$bin/isorender" --again first.png -o again.png --quiet || fail "the picture's scene cannot be drawn"
look same first.png again.png 0 || fail "isorender draws another picture than the window's"
drag 1 640 400 60 20
turned() { picture second && differ first second; }
until_ "another view" turned
"$bin/isorender" --again second.png -o again.png --quiet || fail "the turned picture's scene cannot be drawn"
look same second.png again.png 0 || fail "the turned picture's scene is another picture"
stop

# ---- the picture opens as it was shown
window_program second.png
until_ "the picture's volume" title_is 'stent.nrrd'
picture third
look same second.png third.png 0 || fail "the picture is opened in another view"
stop

# ---- what cannot be opened says why
printf '{"scene": 1, "options": []}' >none.json
"$bin/isosculpt" none.json 2>said && fail "a scene without an input is opened"
grep -qF "none.json: a scene without an input" said || fail "it is not said that the scene has no input"
echo changed >>stent.nrrd
"$bin/isosculpt" figure.json 2>said && fail "a changed volume is opened"
grep -qF "is not the file that it was drawn from" said || fail "it is not said that the volume has changed"
echo "passed"
