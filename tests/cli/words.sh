# words of other programs for options name the right option, or say honestly that there is none; values that people type are read.
python3 -c 'from check import *; ball("in/ball.mha")'
means() { refuses 2 "unknown option $1 ($2)" isorender "$1" 1 in/ball.mha bad.png; }
means --threshold 'did you mean --isovalue?'
means --bg 'did you mean --background?'
means --size 'did you mean --resolution?'
means --Rotate 'did you mean --azimuth?'
means --yaw 'did you mean --azimuth?'
means --abbe 'did you mean --dispersion?'
means --alpha 'did you mean --opacity?'
means --transparent 'did you mean --opacity?'
means --aa 'did you mean --samples?'
means --cmap 'did you mean --colormap?'
means --array 'did you mean --grid or --color-by?'
means --point_size 'did you mean --radius or --glyph-radius?'
means --channels 'did you mean --channel or --component?'
means --stl 'did you mean --mesh?'
means --section 'did you mean --slice?'
means --clipping-plane 'did you mean --clip?'
means --raycast 'did you mean --method?'
means --voxel-size 'did you mean --spacing?'
means --orthogonal 'did you mean --orthographic?'
means --log 'did you mean --verbose?'
means --fill 'did you mean --closed?'
means --keep 'did you mean --largest?'
means --steps 'did you mean --every or --level?'
means --time '--component chooses one of several times of a file, .*'
means --gui 'isosculpt opens a window: .*'
means --blur 'volumes are drawn as they are, without smoothing, .*'
means -isovalue 'did you mean --isovalue?'
means --isovale 'did you mean --isovalue?'
means --zzzzzzz 'see --help'
means --fps 'did you mean --frame-rate?.*'
means --zoom-in 'did you mean --zoom or --mm-per-pixel?'
means --no-gui 'only isosculpt opens a window, .*'
means --up-axis 'did you mean --up or --camera-view-up?'
means --window-level 'did you mean --window?'
means --ssao 'did you mean --occlusion?'
means --show-edges 'did you mean --outline?'
means --labelmap 'did you mean --labels?'
means --interpolation '.*--reconstruction-filter cubic is smooth'
means --color-bar-title 'did you mean --color-bar?'
isorender --help cmap | grep -q -e --colormap
means --metallic 'surfaces are lit by one model; .* --ior makes glass'
means --bone 'a tissue has no name here: .*'
means --jpg 'did you mean --output?'
means --export-stl 'did you mean --mesh?'
refuses 2 'unknown option --input (files are named without an option: .*)' isosculpt --input x.stl
refuses 2 'unknown option --matcap (colours and lights are chosen in the window)' isosculpt --matcap x
# of several words those that are known count, before other options that are spelt nearly so
means --threshold-value 'did you mean --isovalue?'
means --img-size 'did you mean --resolution?'
means --write-stl 'did you mean --mesh?'
means --rotate-about-x 'did you mean --azimuth?'
means --min-sise 'did you mean --min-size?'
means --qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz-qz 'see --help'
means --- 'see --help'
means --dest 'did you mean --output?'
means --mn 'see --help'
means --lamp 'the two lights are fixed; .*'
# words whose options a program lacks are no hint there
refuses 2 'unknown option --yaw (see --help)' isocompare --yaw 3
refuses 2 'unknown option --threshold (did you mean --isovalue?)' isosculpt --threshold 3
isorender_refuses 2 "option --transparency: '0.5' is not one of .*--opacity" in/ball.mha --transparency 0.5
isorender_refuses 2 "option --method: 'raytrace' is not one of .*; raycast follows rays, mesh draws Marching Cubes" in/ball.mha --method raytrace
isorender_refuses 2 "option --camera: '30' is not one of .*--azimuth" in/ball.mha --camera 30
isorender_refuses 2 "option --color: 'transparent' is no colour: an opacity below 1" in/ball.mha --color transparent
refuses 2 'bad.stl: a picture.s name must end in .*(--mesh bad.stl writes' isorender in/ball.mha bad.stl
refuses 2 'bad.exr: a picture.s name must end in .*(--aov bad.exr writes' isorender in/ball.mha bad.exr
refuses 2 'the input comes first: isorender in/ball.mha bad.png' isorender bad.png in/ball.mha
isorender_refuses 2 "option --resolution: '4k' is not WxH: 3840x2160" in/ball.mha --resolution 4k
isorender_refuses 2 "option --resolution: 'big' is neither WxH, such as 1920x1080, nor the side of a square" in/ball.mha --resolution big
isorender in/ball.mha square.png --resolution 50 --quiet
isorender in/ball.mha both.png --resolution 50x50 --quiet
python3 -c 'from check import *; expect(Png("square.png").rows == Png("both.png").rows)'
# all unknown options are said at once
refuses 2 'unknown options --foo (see --help), --isovale (did you mean --isovalue?), --bar (' isorender in/ball.mha bad.png --foo 3 --isovale 500 --samples 4 --bar=-x --quiet
isorender_refuses 2 "option --color: 'rgb(1,0,0)' is neither RRGGBB in hexadecimal, rgb(255,128,0), nor" in/ball.mha --color 'rgb(1,0,0)'
isorender_refuses 2 "option --threads: 'auto' is not a whole number from 1 to 1024 (default: one a processor)" in/ball.mha --threads auto
isorender_refuses 4 "there is no backend 'gpu': auto, cpu, egl or osmesa" in/ball.mha --backend gpu
head -c 3000 /dev/zero >in/what.zzz
isorender_refuses 3 'in/what.zzz: not a volume that can be read: it reads .nrrd, .*DICOM folders, and raw data .*.swc, .*.ply, .*.off' in/what.zzz
python3 - <<'P'
import gzip
import zipfile
with zipfile.ZipFile("in/scan.zarr.zip", "w") as archive:
    archive.writestr("zarr.json", "{}")
with gzip.open("in/scan.tar.gz", "wb") as archive:
    archive.write(b"slices")
P
mkdir in/a.zarr
echo '{}' >in/a.zarr/zarr.json
isorender_refuses 3 'in/scan.zarr.zip: is a .zip archive: unpack it, and name the file or folder in it' in/scan.zarr.zip
isorender_refuses 3 'in/scan.tar.gz: not a NIfTI file, and other files are read when gzip.s compression is undone' in/scan.tar.gz
isorender_refuses 3 'in/a.zarr/zarr.json: is the metadata of an array: name the folder that it is in' in/a.zarr/zarr.json
# values
draw() { isorender in/ball.mha "$1" --quiet --json="$1.json" "${@:2}"; }
draw plain.png --resolution 80x60 --zoom 1.5 --opacity 0.3 --color FFEE00 --background none
draw typed.PNG --resolution 80X60 --zoom 150% --opacity 30% --color '#fe0' --background transparent
draw blanks.png --resolution '80 x 60px' --zoom 1.5 --opacity ' 0.3' --color 'rgb(255, 238, 0)' --background none --up Z --method EXACT --spacing '1 1 1' --crop '0, 23, 0, 23, 0, 23'
cmp plain.png <(isorender in/ball.mha - --quiet --resolution 80x60 --zoom 1.5 --opacity 0.3 --color FFEE00 --background none)
python3 - <<'P'
from check import *
expect(Png("plain.png").pixels() == Png("typed.PNG").pixels() == Png("blanks.png").pixels())
expect(report("plain.png.json")["image"]["hash"] == report("typed.PNG.json")["image"]["hash"])
P
# the argument behind --json is its file when it is named so
isorender --json first.json in/ball.mha last.png --resolution 32x32 --quiet
isorender in/ball.mha --resolution 32x32 --no-image --quiet --json second.JSON
python3 -c 'import json; json.load(open("first.json")); json.load(open("second.JSON"))'
# help as a word, and the version
isorender help | cmp - <(isorender --help)
isocompare help | cmp - <(isocompare --help)
isorender -v | cmp - <(isorender --version)
# a name that no array has is refused with those that there are
cat >in/two.vtk <<'V'
# vtk DataFile Version 3.0
two arrays
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 2 2 2
ORIGIN 0 0 0
SPACING 1 1 1
POINT_DATA 8
SCALARS pressure float 1
LOOKUP_TABLE default
0 1 0 1 0 1 0 1
SCALARS speed float 1
LOOKUP_TABLE default
0 0 0 0 1 1 1 1
V
isorender_refuses 2 "in/two.vtk: no array 'vel', there are 'pressure', 'speed'" in/two.vtk --grid vel
# values of an option that stand as words of their own are no inputs
stray() { refuses 2 "$1: no such file; several values of an option are one word, .*--isovalue 40,90, .*--largest=2" isorender in/ball.mha "${@:2}"; }
stray 2 bad.png --largest 2
stray 2 --largest 2
stray 90 bad.png --isovalue 40 90
stray info bad.png --verbose info
stray blue bad.png --isovalue 40,90 --color red blue
cp in/ball.mha in/ball2.mha
refuses 2 "2 inputs need --output TEMPLATE, such as '{model}.png', not bad.png" isorender in/ball.mha in/ball2.mha bad.png
refuses 2 "option --json: out.json: 2 inputs need an output each: a template, such as '{model}.json'" isorender in/ball.mha in/ball2.mha -o '{model}.png' --json out.json
refuses 2 "option --output: bad.png: 2 inputs need an output each: a template, such as '{model}.png'" isorender in/ball.mha in/ball2.mha -o bad.png
refuses 2 "bad: a picture's name must end in .png, .tif, .jpg, .svg or .pdf, a page's in .html" isorender in/ball.mha bad
# options that are given once for each file are no lists; their names may be in capitals, as those of all options
refuses 2 "--volume-opacity: '.4,1' is not an opacity from 0 to 1; the option is given again for each file" \
    isorender in/ball.mha bad.png --volume in/ball.mha --volume in/ball2.mha --volume-opacity .4,1
refuses 2 "--volume-color: 'red,blue' is neither .*; the option is given again for each file" \
    isorender in/ball.mha bad.png --volume in/ball.mha --volume in/ball2.mha --volume-color red,blue
printf 'x,y,z\n0,0,0\n1,0,0\n' >in/two.csv
isorender in/two.csv two.png --glyph Box --resolution 200x200 --quiet
# slices of one volume are its folder
mkdir in/slices
for i in 1 2 3; do head -c 100 /dev/zero >in/slices/$i.dcm; done
refuses 2 "3 inputs need --output TEMPLATE, .*, not bad.png; slices of one volume are read by their folder: isorender in/slices" isorender in/slices/*.dcm bad.png
refuses 2 "option --output: bad.png: 3 inputs need .*; slices of one volume are read by their folder: isorender in/slices" isorender in/slices/*.dcm -o bad.png
# options of surfaces name those of lines, glyphs and meshes
isorender_refuses 2 "--color is for surfaces of volumes: here it is --glyph-color" in/two.csv --color red
isorender_refuses 2 "--opacity is for surfaces of volumes: here it is --glyph-opacity" in/two.csv --opacity .5
refuses 2 "in/ball.mha: with --headless a file is named by --open, and strokes by --replay" isosculpt in/ball.mha --headless
refuses 2 "bad.png: the picture has a name already: --output other.png" isorender in/ball.mha bad.png -o other.png
