# points that are bad in part are drawn; files that are not what they say are refused with one line and their status.
python3 - <<'P'
import math, random, struct
random.seed(5)
def write(path, points, names="x y z", kind="float", code="f", count=None, order="little"):
    with open(path, "wb") as f:
        f.write(("ply\nformat binary_%s_endian 1.0\nelement vertex %d\n" % (order, count or len(points))
                 + "".join("property %s %s\n" % (kind, n) for n in names.split()) + "end_header\n").encode())
        for p in points:
            f.write(struct.pack(("<" if order == "little" else ">") + code * len(p), *p))
nan = float("nan")
sphere = []
for _ in range(1500):
    v = [random.gauss(0, 1) for _ in range(3)]
    length = math.sqrt(sum(x * x for x in v))
    sphere.append([10 * x / length for x in v])
unit = [[x / 10 for x in p] for p in sphere]
write("in/none.ply", sphere)
write("in/zero.ply", [p + ([0, 0, 0] if i % 3 else n) for i, (p, n) in enumerate(zip(sphere, unit))], "x y z nx ny nz")
write("in/nan.ply", [p + ([nan, 0, 1] if i % 3 else n) for i, (p, n) in enumerate(zip(sphere, unit))], "x y z nx ny nz")
write("in/radii.ply", [p + [0 if i == 1 else -1 if i == 2 else 1000 if i == 3 else nan if i == 4 else 0.6]
                       for i, p in enumerate(sphere)], "x y z radius")
write("in/one.ply", sphere[:1])
write("in/two.ply", sphere[:1] * 2)
write("in/line.ply", [[i / 100, i / 50, -i / 70] for i in range(2000)])
write("in/along_y.ply", [[0, i / 50, 0] for i in range(2000)])
write("in/plane.ply", [[p[0], p[1], 0] for p in sphere])
write("in/place.ply", sphere[:1] * 3000)
write("in/million.ply", sphere[:1] * 500000 + sphere[1:2] * 500000)
write("in/huge.ply", [[3e38, 0, 0], [nan, 0, 0]] + sphere)
write("in/lies.ply", sphere, count=1501)
write("in/absurd.ply", sphere, count=1 << 60)
write("in/two_columns.ply", [p[:2] for p in sphere], "x y")
open("in/text.xyz", "w").write("1 2 3\n4 5\n")
open("in/wide.xyz", "w").write("1 2 3\n4 5 6 7\n")
open("in/word.xyz", "w").write("1 2 3\n4 five 6\n")
open("in/count.pts", "w").write("5\n1 2 3\n")
open("in/empty.xyz", "w").write("")
write("in/no_points.ply", [], count=0)
P
draw() { isorender "in/$1.ply" "$1.png" --quiet --resolution 150x150 --json="$1.json"; }
for name in none zero nan radii one two line along_y plane place million huge; do draw $name; done
python3 - <<'P'
from check import *
r = {n: report(n + ".json") for n in "none zero nan radii one two line along_y plane place million huge".split()}
c = {n: v["image"]["covered"] for n, v in r.items()}
p = {n: v["primitives"] for n, v in r.items()}
expect(p["none"]["estimated_normals"] == 1500 and p["zero"]["estimated_normals"] == p["nan"]["estimated_normals"] == 1000, p)
expect(all(abs(c[n] - c["none"]) < 0.02 * c["none"] for n in ("zero", "nan", "huge")), c)
expect(p["radii"]["estimated_radii"] == 4 and abs(p["radii"]["median_radius"] - 0.6) < 1e-6, p["radii"])
expect(abs(c["radii"] - c["none"]) < 0.1 * c["none"], c)
expect(p["huge"]["dropped"] == 2, p["huge"])
expect(all(c[n] > 1000 for n in ("one", "two", "plane", "place")) and all(c[n] > 30 for n in ("line", "along_y", "million")), c)
P
isorender_refuses 3 'in/lies.ply: truncated: its header promises 1501 of element "vertex"' in/lies.ply
isorender_refuses 3 'in/absurd.ply: truncated' in/absurd.ply
isorender_refuses 3 'in/two_columns.ply: its points have no z' in/two_columns.ply
isorender_refuses 3 'in/text.xyz: row 2: not as many numbers as in the first row' in/text.xyz
isorender_refuses 3 'in/wide.xyz: row 2: not as many numbers as in the first row' in/wide.xyz
isorender_refuses 3 'in/word.xyz: row 2: not as many numbers' in/word.xyz
isorender_refuses 3 'in/count.pts: truncated: it promises 5 points' in/count.pts
isorender_refuses 3 'in/empty.xyz: the file is empty' in/empty.xyz
isorender_refuses 6 'in/no_points.ply: holds no usable point' in/no_points.ply
isorender_refuses 5 'memory' in/million.ply --max-memory 5MB
size=$(stat -c %s in/one.ply)
for ((length = 4; length < size; length++)); do
    head -c $length in/one.ply >in/part.ply
    isorender_refuses 3 'in/part.ply: ' in/part.ply
done
ls -- *.png | grep -q . && [ ! -e part.png ]
