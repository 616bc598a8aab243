# lines, glyphs and a mesh in one picture with a translucent isosurface: right places, right order, right colours
python3 - <<'P'
from check import *
ball("in/ball.mha")
open("in/axis.swc", "w").write("# a line along x with growing radius\n1 1 -40 0 0 1 -1\n2 1 0 0 0 2 1\n3 1 40 0 0 4 2\n")
open("in/two.obj", "w").write("v 0 0 -30\nv 0 0 30\nv 0 -30 0\nv 0 30 0\nl 1 2\nl 3 4\n")
open("in/dots.csv", "w").write("x,y,z,radius,heat\n0,0,30,3,1\n0,0,-30,3,2\n30,0,0,6,5\n")
P
isorender --lines in/axis.swc axis.png --camera front --orthographic --resolution 200x200 --json=axis.json --quiet
isorender --lines in/two.obj --tube-radius 2 --line-color direction two.png --camera left --resolution 200x200 --quiet
isorender --glyphs in/dots.csv dots.png --color-by heat --colormap gray --range 0,10 --color-bar --json=dots.json --quiet
isorender in/ball.mha alone.png --isovalue 500 --mesh ball.stl --quiet
isorender in/ball.mha all.png --isovalue 500 --opacity 0.3 --lines in/axis.swc --lines in/two.obj --line-color red \
    --line-color 00FF00 --tube-radius 1 --glyphs in/dots.csv --json=all.json --quiet
isorender in/ball.mha one.png --isovalue 500 --opacity 0.3 --lines in/axis.swc --lines in/two.obj --line-color red \
    --line-color 00FF00 --tube-radius 1 --glyphs in/dots.csv --threads 1 --quiet
cmp all.png one.png
isorender --surface ball.stl mesh.png --camera front --quiet --json=mesh.json
isorender in/ball.mha truth.png --isovalue 500 --method mesh --camera front --quiet
isocompare images truth.png mesh.png --fail-under psnr=35 >/dev/null
python3 - <<'P'
import json
axis, dots, every, mesh = (json.load(open(n + ".json")) for n in ("axis", "dots", "all", "mesh"))
line = axis["objects"][0]
assert line["lines"] == 1 and line["vertices"] == 3 and line["format"] == "swc", line
low_x, high_x, low_y, high_y = line["bounds_world"][:4]
assert -44.01 < low_x < -40.99 and abs(high_x - 44) < 1e-3 and abs(high_y - 4) < 1e-3, line
assert dots["objects"][0]["glyphs"] == 3 and dots["objects"][0]["range"] == [0, 10], dots["objects"]
assert [o["path"] for o in every["objects"]] == ["in/axis.swc", "in/two.obj", "in/dots.csv"]
assert every["image"]["layers"]["most"] >= 2 and mesh["objects"][0]["triangles"] > 1000
P
# a .vtk file without an option: lines if it holds polygonal data, else a volume
printf '# vtk DataFile Version 3.0\nline\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 -30 0 0 30\nLINES 1 3\n2 0 1\n' >in/line.vtk
isorender in/line.vtk vtk.png --tube-radius 2 --json=vtk.json --quiet
isorender --lines in/line.vtk vtk_lines.png --tube-radius 2 --quiet
isocompare images vtk.png vtk_lines.png --fail-under psnr=150 >/dev/null # the same pixels
printf '1 1 90 0 0 1 -1\n2 1 95 0 0 1 1\n' >in/far.swc
isorender --lines in/axis.swc --lines in/far.swc far.png 2>notes # each file against those before it
[ "$(grep -c "in/far.swc lies beside the rest: .* --space ras" notes)" = 1 ]
code=0
isorender --lines in/axis.swc none.png --zoom 50 --camera-focal-point 0,0,30 2>notes || code=$?
[ $code -eq 6 ]
grep -q "nothing is in view" notes
[ ! -e none.png ]
isorender --info --glyphs in/dots.csv >info
isorender --info --lines in/two.obj >>info
grep -q "heat: 1 .. 5" info
grep -q "lps (not stated in the file)" info
isorender_refuses 2 "has no column 'warmth'; its columns: .*heat" --glyphs in/dots.csv --color-by warmth
isorender_refuses 2 "--glyph-color and --color-by both" --glyphs in/dots.csv --color-by heat --glyph-color red
isorender_refuses 2 "two.obj: --line-color and --color-by both" --lines in/two.obj --color-by heat --line-color direction
isorender_refuses 2 "given 2 times for 1" --lines in/two.obj --tube-radius 1 --tube-radius 2
isorender_refuses 2 "is for --lines, which is not given" --glyphs in/dots.csv --caps flat
isorender_refuses 2 "not one of round, flat" --lines in/two.obj --caps square
isorender_refuses 2 "not two numbers" --glyphs in/dots.csv --color-by heat --range 3,1
isorender_refuses 2 "is not two shares" --glyphs in/dots.csv --color-by heat --range 90%,10%
isorender_refuses 2 "is not two shares" --glyphs in/dots.csv --color-by heat --range 0%,101%
isorender_refuses 2 "not two numbers" --glyphs in/dots.csv --color-by heat --range 10%,90
# shares of a column's numbers: of 0 .. 100 those at 5 and at 90
python3 -c 'print("x,y,z,radius,heat"); [print(i % 10, i // 10, 0, .4, (i * 37) % 101, sep=",") for i in range(101)]' >in/hundred.csv
isorender --glyphs in/hundred.csv shares.png --color-by heat --range 5%,90% --resolution 120x120 --quiet
isorender --glyphs in/hundred.csv numbers.png --color-by heat --range 5,90 --resolution 120x120 --quiet
python3 -c 'from check import *; expect(Png("shares.png").rows == Png("numbers.png").rows)'
isorender_refuses 2 "needs\|glass" in/ball.mha --glyphs in/dots.csv --ior 1.5
isorender_refuses 2 "is for surfaces" --glyphs in/dots.csv --isovalue 5
isorender in/axis.swc input.png --camera front --orthographic --resolution 200x200 --quiet
isocompare images axis.png input.png --fail-under psnr=100 >/dev/null
# a column is the glyphs' own, a colour that of the lines: neither is overruled by what repeats
isorender --glyphs in/dots.csv --color-by heat --lines in/two.obj --line-color 123456 own.png --json=own.json --quiet
python3 -c "import json, sys
objects = json.load(open('own.json'))['objects']
sys.exit(not ('range' in objects[0] and 'range' not in objects[1]))"
isorender_refuses 2 "none of them is given" --glyphs in/dots.csv --color-bar
isorender_refuses 2 "a radius of -1 mm" --lines in/two.obj --tube-radius -1
rm -f said
