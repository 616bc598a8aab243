# translucent lines and glyphs: their layers along a ray, their order among isosurfaces, and what they are refused with
python3 - <<'P'
from check import *
ball("in/ball.mha")  # surfaces at 500 (radius 8) and 800 (radius 3.2) around 11.5, 11.5, 11.5
# a bent tube with many joints, and a straight one across it
steps = ["v %g 11.5 %g" % (1.5 + i, 11.5 + (0 if 6 <= i <= 14 else 4)) for i in range(21)]
open("in/bent.obj", "w").write("\n".join(steps) + "\nv 11.5 4 0\nv 11.5 4 24\nl " + " ".join(map(str, range(1, 22))) + "\nl 22 23\n")
open("in/dots.csv", "w").write("x,y,z,radius\n11.5,0,11.5,2\n11.5,11.5,11.5,1\n")
P
view="--camera-position 11.5,-60,11.5 --camera-focal-point 11.5,11.5,11.5 --resolution 81x81 --opacity-mode constant --quiet"
lines="--lines in/bent.obj --tube-radius 1 --line-color red"
isorender $lines --line-opacity 0.5 tubes.png $view --json=tubes.json
isorender $lines --line-opacity 0.5 --layers 1 skin.png $view --json=skin.json
isorender $lines --line-opacity 0.5 --line-style ribbon ribbons.png $view --json=ribbons.json
isorender in/ball.mha all.png --isovalue 500 --opacity 0.5 $lines --line-opacity 0.5 --glyphs in/dots.csv \
    --glyph-opacity 0.25 --glyph-color blue $view --json=all.json --samples 4
isorender in/ball.mha one.png --isovalue 500 --opacity 0.5 $lines --line-opacity 0.5 --glyphs in/dots.csv \
    --glyph-opacity 0.25 --glyph-color blue $view --threads 1 --samples 4
cmp all.png one.png
isorender in/ball.mha solid.png --isovalue 500 $lines --line-opacity 0.5 $view --json=solid.json # an opaque ball hides what is in it
isorender --lines in/bent.obj --lines in/bent.obj --tube-radius 1 --line-opacity 0.5 --line-opacity 1 both.png $view --json=both.json
python3 - <<'P'
from check import *
tubes, skin, ribbons, every, solid, both = (report(n + ".json") for n in ("tubes", "skin", "ribbons", "all", "solid", "both"))
expect(tubes["image"]["layers"]["most"] == 4, tubes["image"]["layers"])  # where the tubes cross; joints add none
expect(skin["image"]["layers"]["most"] == 1, skin["image"]["layers"])
expect(ribbons["image"]["layers"]["most"] <= 2, ribbons["image"]["layers"])
line = tubes["objects"][0]
expect(line["opacity"] == 0.5 and line["samples"] > 200 and 2 * line["samples"] <= line["layers"] <= 4 * line["samples"], line)
expect([o["opacity"] for o in every["objects"]] == [0.5, 0.25], every["objects"])
expect(every["image"]["layers"]["most"] == 10, every["image"]["layers"])  # ball 2, line 2 + 2, glyphs 2 + 2
expect(0 < solid["objects"][0]["layers"] < line["layers"], solid["objects"], line)
expect("opacity" not in both["objects"][1] and both["objects"][1]["samples"] > 200, both["objects"])
P
# a mesh of the isosurface is seen through as the isosurface is
isorender in/ball.mha --isovalue 500 --mesh ball.ply --no-image --quiet
isorender in/ball.mha iso.png --isovalue 500 --opacity 0.5 --color ivory $view --json=iso.json
isorender --surface ball.ply --surface-opacity 0.5 --surface-color ivory mesh.png $view --json=mesh.json
isocompare images iso.png mesh.png --fail-under psnr=35 >/dev/null
python3 - <<'P'
from check import *
iso, mesh = report("iso.json")["image"], report("mesh.json")
expect(mesh["image"]["layers"]["most"] == 2 == iso["layers"]["most"], mesh["image"])
expect(abs(mesh["objects"][0]["samples"] - iso["covered"]) < 30 and mesh["objects"][0]["opacity"] == 0.5, mesh["objects"], iso)
P
if ! isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then
    isorender $lines --line-opacity 0.5 aov.png --aov aov.exr $view
    python3 - <<'P'
from check import *
picture = Exr("aov.exr")
for a, layers in zip(picture.planes["A"], picture.planes["layers"]):
    expect(abs(a - (1 - 0.5 ** layers)) < 1e-5 and layers in (0, 1, 2, 4), a, layers)
P
fi
isorender_refuses 2 "not an opacity from 0 to 1" $lines --line-opacity 1.5
isorender_refuses 2 "is for --glyphs, which is not given" $lines --glyph-opacity 0.5
isorender_refuses 2 "cannot draw translucent lines, glyphs and meshes (--line-opacity): that needs exact" scene:sphere:16 $lines --line-opacity 0.5 --method raycast
isorender_refuses 2 "no --lines, --glyphs and --surface beside it" scene:sphere:16 $lines --line-opacity 0.5 --ior 1.5
isorender_refuses 2 "draws no translucent objects" $lines --line-opacity 0.5 --backend osmesa
isorender_refuses 2 "(--surface-opacity): that needs exact" scene:sphere:16 --surface ball.ply --surface-opacity 0.5 --method mesh
isorender_refuses 2 "--absorption is for translucent surfaces" $lines --line-opacity 0.5 --absorption 5
isorender_refuses 2 "--layers is for translucent surfaces" $lines --layers 2
isorender scene:sphere:16 --points points.ply --no-image --quiet
isorender_refuses 2 "holds points, not a volume: --line-opacity needs a volume" points.ply $lines --line-opacity 0.5
# more layers than memory has room for
python3 -c 'open("in/many.csv", "w").write("x,y,z,radius\n" + "".join("0,0,%g,50\n" % (i * 1e-2) for i in range(2500)))'
isorender_refuses 5 "memory" --glyphs in/many.csv --glyph-opacity 0.0001 --opacity-mode constant --max-memory 56M --threads 1 --resolution 1000x2 --zoom 3000 --orthographic
rm -f said
