#!/bin/bash
# Surfaces coloured by data, in a real window under Xvfb: by curvature, depth, normals and another volume, chosen in the panel
# and by scenes. What is shown is what isorender draws again from the picture's scene, to the same pixels.
# colors.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
cp "$volumes/stent.nrrd" stent.nrrd

# ---- by curvature, chosen in the panel's section, at the bottom of the panel
window_program stent.nrrd --isovalue 300
until_ "the volume" title_is 'stent.nrrd'
picture plain
whole_window before
press 80 614
opened() { whole_window section && differ before section; }
until_ "the panel's section" opened

colored() { picture "$1" && [ "$(option "$1" surface-color-by)" = "$2" ]; }
press 110 645
press 48 694
until_ "colours by curvature" colored curvature curvature
redrawn curvature
differ plain curvature || fail "the surface is not coloured"
whole_window bar
look color bar.png 224 224 224 1180,20,1270,230 20 >/dev/null || fail "no bar of the numbers"

# ---- a dragged end of the range stays; so it does when the camera moves
xdotool mousemove 60 701 sleep 0.3 mousedown 1 sleep 0.3 mousemove 70 701 sleep 0.2 mousemove 100 701 sleep 0.3 mouseup 1
ranged() { picture ranged && [ -n "$(option ranged range)" ]; }
until_ "a range" ranged
redrawn ranged
drag 1 700 400 80 30
turned() { picture turned && differ ranged turned; }
until_ "another camera" turned
redrawn turned
[ "$(option turned range)" = "$(option ranged range)" ] || fail "the range changed with the camera"

# ---- another map, and the range of the surface again; by depth, whose range is the view's
press 110 673
press 48 545
mapped() { picture mapped && [ -n "$(option mapped colormap)" ]; }
until_ "another map" mapped
redrawn mapped
press 80 729
found() { picture found && [ -z "$(option found range)" ]; }
until_ "the surface's own range" found
redrawn found
press 110 645
press 48 714
until_ "colours by depth" colored depth depth
redrawn depth
press 110 645
press 48 674
uncolored() { picture uncolored && [ -z "$(option uncolored surface-color-by)" ]; }
until_ "no colours" uncolored
redrawn uncolored

# ---- by another volume, chosen in the dialog: here of the same values, upside down
python3 - <<'PYTHON'
header, voxels = open("stent.nrrd", "rb").read().split(b"\n\n", 1)
open("other.nrrd", "wb").write(header + b"\n\n" + voxels)
PYTHON
press 110 645
press 48 754
until_ "the dialog" is_modal
xdotool type "$work/other.nrrd"
key Return
until_ "colours by a volume" colored volume other.nrrd
redrawn volume

# ---- by the distance from its surface, and from a mesh
press 110 645
press 48 774
until_ "the dialog" is_modal
xdotool type "$work/other.nrrd"
key Return
until_ "colours by distance" colored distance distance:other.nrrd
redrawn distance
differ volume distance || fail "distances are coloured as the volume's values"
stop

# ---- the picture opens as it was shown; so does a scene with two surfaces, of which one is translucent
window_program volume.png
until_ "the picture's volume" title_is 'stent.nrrd'
picture opened
look same volume.png opened.png 0 || fail "the picture is opened in another way"
stop
"$bin/isorender" stent.nrrd --isovalue 200,700 --opacity 0.4,1 --surface-color-by curvature --colormap turbo --range -2,3 \
    --background 2E3238 --azimuth 20 --resolution 976x800 --samples 4 --output scene.png --save-scene figure.json --quiet ||
    fail "isorender saves no scene"
window_program figure.json
until_ "the scene's volume" title_is 'stent.nrrd'
picture scene_opened
look same scene.png scene_opened.png 0 || fail "the scene is opened as another picture"
redrawn scene_opened
stop

# ---- distances from a mesh, and from an isovalue, are opened as isorender draws them
"$bin/isorender" stent.nrrd --isovalue 1200 --mesh core.ply --no-image --quiet || fail "no mesh"
for from in core.ply other.nrrd:900; do
    "$bin/isorender" stent.nrrd --isovalue 700 --surface-color-by "distance:$from" --background 2E3238 --resolution 976x800 --samples 4 \
        --output scene.png --save-scene distance.json --quiet || fail "isorender draws no distances from $from"
    window_program distance.json
    until_ "the scene's volume" title_is 'stent.nrrd'
    picture distance_opened
    look same scene.png distance_opened.png 0 || fail "distances from $from are opened as another picture"
    redrawn distance_opened
    stop
done

# ---- a file that is gone is missed by name; the picture is there, without colours
sed 's/"curvature"/"distance:gone.nrrd"/' figure.json >gone.json
window_program gone.json
until_ "the scene's volume" title_is 'stent.nrrd'
until_ "a file that is missed" says "gone.nrrd"
stop
echo "passed"
