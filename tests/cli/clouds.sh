# a file of points without normals and radii: both are estimated; options choose others; coordinates far from 0.
python3 - <<'P'
import math, random
random.seed(4)
def cloud(path, shift, count, colors=False):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n" % count)
        f.write("property uchar red\nproperty uchar green\nproperty uchar blue\n" * colors + "end_header\n")
        for i in range(count):
            v = [random.gauss(0, 1) for _ in range(3)]
            r = 10 / math.sqrt(sum(x * x for x in v))
            f.write(" ".join("%.9g" % (shift + x * r) if not shift else repr(shift + x * r) for x in v))
            f.write((" 200 30 10" if v[0] > 0 else " 10 30 200") * colors + "\n")
cloud("in/near.ply", 0, 4000)
cloud("in/far.ply", 5000000, 4000)
cloud("in/colored.ply", 0, 4000, True)
P
isorender in/near.ply near.png --json=near.json --quiet --resolution 200x200
isorender in/far.ply far.png --json=far.json --quiet --resolution 200x200
isorender in/colored.ply colored.png --json=colored.json --quiet --resolution 200x200 --camera right
isorender in/near.ply large.png --radius 3 --json=large.json --quiet --resolution 200x200
isorender in/near.ply half.png --crop-mm 0,20,-20,20,-20,20 --json=half.json --quiet --resolution 200x200
isorender --info in/near.ply >info
isorender scene:sphere:48 --no-image --points in/own.ply --quiet
isorender in/own.ply own.png --json=own.json --quiet --resolution 200x200
isorender in/own.ply auto.png --normals auto --radius auto --json=auto.json --quiet --resolution 200x200
python3 - <<'P'
from check import *
near, far, colored, large, half, own, auto = (report(n + ".json") for n in "near far colored large half own auto".split())
p = near["primitives"]
expect(p["points"] == p["estimated_normals"] == p["estimated_radii"] == 4000 and near["method"] == "splats", near)
expect(0.4 < p["median_radius"] < 0.8, p)
# a ball of 10 mm in the picture: no hole, and about its outline
def covered(r): return r["image"]["covered"]
expect(abs(covered(far) - covered(near)) < 0.01 * covered(near), covered(far), covered(near))
expect(abs(far["bounds_world"][0] - 4999990) < 0.1, far["bounds_world"])
expect(large["primitives"]["median_radius"] == 3 and large["primitives"]["estimated_radii"] == 0, large["primitives"])
expect(covered(large) > 1.1 * covered(near), covered(large))
expect(1800 < half["primitives"]["points"] < 2200 and half["bounds_world"][0] >= 0, half)
q, a = own["primitives"], auto["primitives"]
expect(q["estimated_normals"] == q["estimated_radii"] == 0 and a["estimated_normals"] == a["estimated_radii"] == a["points"], q, a)
expect(abs(covered(own) - covered(auto)) < 0.03 * covered(own), covered(own), covered(auto))
middle = Png("colored.png").rows[100][100]
expect(middle[0] > 2 * middle[2] or middle[2] > 2 * middle[0], middle)
info = open("info").read()
expect("normals     estimated" in info and "points      4000" in info and "colours     none" in info, info)
P
cat >in/heat.ply <<'P'
ply
format ascii 1.0
element vertex 6
property float x
property float y
property float z
property float heat
end_header
0 0 0 1
9 0 0 2
0 0 9 3
9 0 9 4
0 4 0 5
9 4 9 9
P
isorender in/heat.ply heat.png --color-by heat --colormap gray --color-bar --json=heat.json --quiet --resolution 200x200
isorender in/heat.ply third.png --color-by heat --range 0,5 --every 3 --space ras --json=third.json --quiet --resolution 200x200
isorender --info in/heat.ply | grep -q "columns *heat: 1 .. 9"
python3 - <<'P'
from check import *
heat, third = report("heat.json"), report("third.json")
expect(heat["primitives"]["range"] == [1, 9], heat["primitives"])
expect(third["primitives"]["range"] == [0, 5] and third["primitives"]["points"] == 2, third["primitives"])
expect(abs(third["bounds_world"][0] + 9) < 1e-5 and abs(third["bounds_world"][1]) < 1e-5, third["bounds_world"])
P
isorender_refuses 2 "'0' is neither a radius in mm nor 'auto'" in/near.ply --radius 0
isorender_refuses 6 "no point lies in this box" in/near.ply --crop-mm 50,60,0,1,0,1
isorender_refuses 2 "heat.ply: has no column 'warmth'; its columns: heat; and x, y, z$" in/heat.ply --color-by warmth
isorender_refuses 2 "is for --lines, --glyphs or a file of points, which is not given" scene:sphere:16 --color-by heat
isorender_refuses 2 "needs a volume" in/near.ply --crop 0,1,0,1,0,1
# opacities of points: a disc in front of another, with a column alpha of bytes, of fractions, or of no use
python3 - <<'P'
def sheets(path, kind, alpha):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex 800\n")
        f.write("".join("property float %s\n" % n for n in ("x", "y", "z", "nx", "ny", "nz", "radius")))
        f.write("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty %s alpha\nend_header\n" % kind)
        for y, color in ((-5, "255 0 0"), (5, "0 0 255")):
            for i in range(400):
                f.write("%d %d %d 0 -1 0 .7 %s %s\n" % (i % 20, y, i // 20, color, alpha(y)))
sheets("in/bytes.ply", "uchar", lambda y: 102 if y < 0 else 255)
sheets("in/fractions.ply", "float", lambda y: .4 if y < 0 else 1)
sheets("in/opaque.ply", "uchar", lambda y: 255)
sheets("in/nothing.ply", "uchar", lambda y: 0)
P
view="--camera front --resolution 100x100 --quiet"
for name in bytes fractions opaque nothing; do isorender in/$name.ply $name.png $view --json=$name.json; done
isorender in/bytes.ply solid.png $view --opacity 1 --json=solid.json
isorender in/bytes.ply half.png $view --opacity .5 --opacity-mode constant --json=half.json
isorender in/opaque.ply through.png $view --opacity .5 --opacity-mode constant --json=through.json
isorender in/bytes.ply pull.png --camera front --resolution 100x100 --method discs --points in/kept.ply --json=pull.json 2>said
grep -q "note: its points have opacities, but --method discs cannot draw them: that needs splats (groups or flat)" said || { cat said; exit 1; }
isorender in/kept.ply kept.png $view --json=kept.json
isorender --info in/bytes.ply | grep -q "opacities   of the file"
isorender in/nothing.ply nothing.png --camera front --resolution 100x100 2>said
grep -q "its column alpha is 0 throughout and is not used" said || { cat said; exit 1; }
python3 - <<'P'
from check import *
def middle(name): return Png(name + ".png").rows[50][50]
b, solid, half = middle("bytes"), middle("solid"), middle("half")
expect(solid[0] > 150 and solid[2] < 60, solid)
for name in "opaque", "nothing", "pull": expect(max(abs(x - y) for x, y in zip(middle(name), solid)) < 3, name, middle(name), solid)
# .4 of the red sheet over the blue one; then .2 of red over half of blue over the background
expect(abs(b[0] - .4 * solid[0] - .6 * solid[2]) < 6 and abs(b[2] - .6 * solid[0] - .4 * solid[2]) < 6, b, solid)
expect(half[2] > half[0] and half != b, half, b)
through = middle("through")
expect(solid[0] - through[0] > 20 and report("through.json")["image"]["layers"]["most"] >= 2, through, solid)
expect(Png("fractions.png").rows == Png("bytes.png").rows == Png("kept.png").rows, "differ")
expect(report("bytes.json")["opacities"] == [1] and "opacities" not in report("opaque.json"), report("bytes.json"))
expect(report("bytes.json")["image"]["layers"]["most"] >= 2, report("bytes.json"))
P
isorender_refuses 2 "needs an opacity below 1" in/opaque.ply --opacity-mode constant
