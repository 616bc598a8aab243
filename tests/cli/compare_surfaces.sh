# surfaces are compared with each other: balls, tori, a volume and its mesh; table, JSON and page; the same with every number of
# threads; what cannot be is refused
python3 - <<'P'
from check import *
import math
def ball(r): return lambda x, y, z: 10 * (r - math.dist((x, y, z), (15.2, 15.7, 14.9)))
def torus(r): return lambda x, y, z: 10 * (r - math.hypot(math.hypot(x - 15.2, y - 15.7) - 9, z - 14.9))
volume("in/small.mha", (32, 32, 32), ball(8), header="ElementSpacing = 2 2 2\n")
volume("in/large.mha", (32, 32, 32), ball(11), header="ElementSpacing = 2 2 2\n")
volume("in/thin.mha", (32, 32, 32), torus(3), header="ElementSpacing = 2 2 2\n")
volume("in/thick.mha", (32, 32, 32), torus(4), header="ElementSpacing = 2 2 2\n")
P
isocompare surfaces in/small.mha in/large.mha --isovalue 0 --json=balls.json --output page.html --side 64 >table
isocompare surfaces in/small.mha in/large.mha --isovalue 0 --json=one.json --threads 1 --quiet
cmp balls.json one.json
isocompare surfaces in/thin.mha:0 in/thick.mha:0 --json=tori.json --quiet
isocompare surfaces in/thin.mha:0 in/thin.mha:10 --json=levels.json --quiet
isorender in/small.mha --isovalue 0 --no-image --mesh small.ply --quiet
isocompare surfaces small.ply in/large.mha:0 --json=mesh.json --quiet --output mesh.html --side 64
isocompare surfaces small.ply small.ply --json >same.json
grep -q "^dice" table
python3 - <<'P'
from check import *
import math
def near(value, wanted, tolerance, *what): expect(abs(value - wanted) <= tolerance, what, value, wanted)
# interpolation moves the surface of a ball of radius r inwards by 3 / (8 r) voxels at most
balls = report("balls.json")
for side, sign in (("a", -1), ("b", 1)):
    near(balls[side]["mean"], 6, .1, side)
    near(balls[side]["signed_mean"], sign * 6, .1, side)
    near(balls[side]["hausdorff"], 6, .12, side)
near(balls["a"]["area"], 4 * math.pi * 16 ** 2, 40, "area")
near(balls["b"]["volume"], 4 / 3 * math.pi * 22 ** 3, 600, "volume")
near(balls["dice"], 2 * 8 ** 3 / (8 ** 3 + 11 ** 3), .005, "dice")
tori = report("tori.json")
near(tori["a"]["mean"], 2, .15, "torus")
near(tori["b"]["hausdorff"], 2, .25, "torus")
near(tori["dice"], 2 * 9 / (9 + 16), .02, "torus")
near(report("levels.json")["mean_of_both"], 2, .2, "levels")
mesh = report("mesh.json")
near(mesh["a"]["mean"], 6, .1, "mesh")
near(mesh["dice"], balls["dice"], .01, "mesh")
same = report("same.json")
expect(same["hausdorff_of_both"] < 1e-9 and same["dice"] == 1, same)
for name in ("page.html", "mesh.html"):
    page = open(name).read()
    expect(page.count("data:image/png;base64,iVBOR") == 4 and "Hausdorff".lower() in page, name)
P
refuses 2 "takes two volumes or meshes" isocompare surfaces in/small.mha
refuses 2 "does not belong to surfaces" isocompare surfaces in/small.mha in/large.mha --voxel 3
refuses 3 "nothing.mha" isocompare surfaces in/small.mha:0 nothing.mha
refuses 6 "in/large.mha: no surface at isovalue 1e+06" isocompare surfaces in/small.mha:0 in/large.mha:1e6
refuses 7 "nowhere" isocompare surfaces in/small.mha:0 in/large.mha:0 --output nowhere/bad.html --side 64
