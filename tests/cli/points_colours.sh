# Colours of points as files have them: names of several programs, fractions and bytes as floats, packed Gaussians, flat ones;
# and those that mean nothing: 0 throughout. Points that a depth camera did not measure are no points.
python3 - <<'P'
import math, random, struct
random.seed(3)
def sphere(count):
    for k in range(count):
        z = 1 - (2 * k + 1) / count
        a, r = 2.399963 * k, math.sqrt(1 - z * z)
        yield (10 * r * math.cos(a), 10 * r * math.sin(a), 10 * z)
points = list(sphere(400))
colors = [(random.randrange(256), random.randrange(256), random.randrange(256)) for _ in points]
def ply(name, names, rows, kind="float"):
    with open("in/%s.ply" % name, "w") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(rows))
        f.write("".join("property float %s\n" % n for n in "xyz") + "".join("property %s %s\n" % (kind, n) for n in names))
        f.write("end_header\n" + "".join(" ".join("%.9g" % v for v in row) + "\n" for row in rows))
with_colors = [p + c for p, c in zip(points, colors)]
ply("bytes", ["red", "green", "blue"], with_colors, "uchar")
ply("diffuse", ["diffuse_red", "diffuse_green", "diffuse_blue"], with_colors, "uchar")
ply("floats", ["red", "green", "blue"], with_colors)
ply("fractions", ["red", "green", "blue"], [p + tuple(v / 255 for v in c) for p, c in zip(points, colors)])
ply("black", ["red", "green", "blue"], [p + (0, 0, 0) for p in points], "uchar")
ply("plain", [], points)
ply("zeros", [], points[:200] + [(0, 0, 0)] * 50 + points[200:])
# as those of scanners, which are mapped when the radius is given
ply("normals", ["nx", "ny", "nz"], [p + tuple(v / 10 for v in p) for p in points])
normals = [struct.pack("<6f3B", *p, *(v / 10 for v in p), 0, 0, 0) for p in points]
head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" + "".join("property float %s\n" % n for n in ("x", "y", "z", "nx", "ny", "nz")) \
    + "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
open("in/black_normals.ply", "wb").write((head % 400).encode() + b"".join(normals))
hole = struct.pack("<6f3B", 0, 0, 0, 0, 0, 1, 0, 0, 0)
open("in/zeros_normals.ply", "wb").write((head % 450).encode() + b"".join(normals + [hole] * 50))
# LAS: 400 points of format 2, colours 0
las = bytearray(227)
las[0:4], las[24], las[25], las[104] = b"LASF", 1, 2, 2
struct.pack_into("<HIIBHI", las, 94, 227, 227, 0, 2, 26, 400)
struct.pack_into("<6d", las, 131, .001, .001, .001, 0, 0, 0)
open("in/black.las", "wb").write(las + b"".join(struct.pack("<3i14x", *(round(1000 * v) for v in p)) for p in points))
P
for name in bytes diffuse floats fractions plain black zeros; do
    isorender in/$name.ply $name.png --resolution 100x100 --json=$name.json 2>$name.said
done
isorender in/black.las las.png --resolution 100x100 --json=las.json 2>las.said
for name in normals black_normals zeros_normals; do
    isorender in/$name.ply $name.png --resolution 100x100 --radius 1.5 --json=$name.json 2>$name.said
done
grep -q 'note: its colours are 0 throughout and are not used' black.said las.said black_normals.said
grep -q 'note: 50 points lie at exactly 0 0 0' zeros.said
grep -q 'note: 50 points lie at exactly 0 0 0' zeros_normals.said
python3 - <<'P'
from check import *
names = "bytes diffuse floats fractions plain black zeros las normals black_normals zeros_normals".split()
image = {n: report(n + ".json")["image"]["hash"] for n in names}
expect(image["bytes"] == image["diffuse"] == image["floats"] == image["fractions"] != image["plain"], "colours", image)
expect(image["plain"] == image["black"], "0 throughout", image)
expect(image["normals"] == image["black_normals"] == image["zeros_normals"], "mapped", image)
expect(report("zeros.json")["bounds_world"] == report("plain.json")["bounds_world"], "unmeasured points")
expect(sum(max(p[:3]) for p in Png("las.png").pixels() if p[3]) > 100 * 100 * 50, "the points of .las are black")
P
