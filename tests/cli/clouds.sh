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
isorender_refuses 2 "heat.ply: has no column 'warmth'; its columns: heat$" in/heat.ply --color-by warmth
isorender_refuses 2 "is for --lines, --glyphs or a file of points, which is not given" scene:sphere:16 --color-by heat
isorender_refuses 2 "needs a volume" in/near.ply --crop 0,1,0,1,0,1
