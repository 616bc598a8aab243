# what a picture of points frames: all of them, but for a few that lie far away; flat landscapes from above; large discs whole.
# Map coordinates keep their precision through --points. A .vtp of points only is drawn as glyphs.
python3 - <<'P'
import math, random
random.seed(2)
def write(path, points):
    with open(path, "w") as f:
        for p in points:
            f.write("%.4f %.4f %.4f\n" % tuple(p))
def ball(count, shift=0):
    for _ in range(count):
        v = [random.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        yield [shift + 10 * x / length for x in v]
sphere = list(ball(3000))
write("in/ball.xyz", sphere)
write("in/outliers.xyz", [[5000, 0, 0]] * 3 + sphere + [[0, -9000, 800]])
write("in/land.xyz", [[random.uniform(0, 100), random.uniform(0, 80), random.uniform(0, 5)] for _ in range(3000)])
write("in/plane.xyz", [[random.uniform(0, 100), random.uniform(0, 80), 0] for _ in range(2000)])
write("in/map.txt", ball(2000, 5403850.25))
write("in/one.xyz", [[3, 4, 5]])
P
for name in outliers land plane one; do isorender in/$name.xyz $name.png --json=$name.json --quiet --resolution 200x200; done
isorender in/ball.xyz ball.png --fit box --json=ball.json --quiet --resolution 200x200
isorender in/ball.xyz usual.png --json=usual.json --quiet --resolution 200x200 # as it is seen: without outliers
isorender in/outliers.xyz said.png --resolution 200x200 2>said
grep -q "note: 4 of 3004 points lie far from the others, and are not framed (--fit tight does)" said
isorender in/outliers.xyz tight.png --fit tight --json=tight.json --quiet --resolution 200x200 || true
isorender in/land.xyz top.png --camera front --fit box --json=edge.json --quiet --resolution 200x200
isorender in/map.txt --no-image --points in/map.ply --quiet
python3 - <<'P'
import struct
from check import *
ball, usual, outliers, land, plane, edge, one = (report(n + ".json") for n in "ball usual outliers land plane edge one".split())
def covered(r): return r["image"]["covered"]
expect(abs(covered(ball) - covered(outliers)) < 0.02 * covered(ball), covered(ball), covered(outliers))
expect(covered(usual) > 1.1 * covered(ball), covered(usual), covered(ball))
expect(outliers["bounds_world"][1] == 5000, outliers["bounds_world"])
expect(covered(land) > 3 * covered(edge) and covered(plane) > 5000, covered(land), covered(edge), covered(plane))
expect(10000 < covered(one) < 35000, covered(one)) # a disc, not cut off by the picture
data = open("in/map.ply", "rb").read()
begin = data.index(b"end_header\n") + 11
expect(b"property double x" in data[:begin] and b"property float nx" in data[:begin], data[:begin])
got = sorted(struct.unpack_from("<ddd", data, begin + 40 * i) for i in range(2000))
wanted = sorted(tuple(map(float, line.split())) for line in open("in/map.txt"))
worst = max(abs(g - w) for a, b in zip(got, wanted) for g, w in zip(a, b))
expect(worst < 1e-5, worst)
P
cat >in/stars.vtp <<'P'
<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="3" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 9 0 0 0 0 9</DataArray></Points>
</Piece></PolyData></VTKFile>
P
isorender in/stars.vtp stars.png --json=stars.json --quiet --resolution 100x100
grep -q '"kind": *"glyphs"\|"glyphs"' stars.json
