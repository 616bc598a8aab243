# Scans in E57: floats, integers and scaled integers of any number of bits, in packets that end anywhere; poses, spherical coordinates,
# invalid points, colours and normals; against the same points in .ply. Damaged ones are refused.
cat >in/make.py <<'P'
import math, random, struct
from check import *
from e57_files import e57
random.seed(7)
def scaled(name, scale, least, most, **more): return {"name": name, "type": "ScaledInteger", "minimum": least, "maximum": most, "scale": scale, **more}
def single(name): return {"name": name, "type": "Float", "precision": "single"}
def whole(name, least, most): return {"name": name, "type": "Integer", "minimum": least, "maximum": most}
ball = []
while len(ball) < 3000:
    n = [random.gauss(0, 1) for _ in range(3)]
    length = math.sqrt(sum(v * v for v in n))
    n = [v / length for v in n]
    ball.append(([round(2 * v, 3) for v in n], n, [random.randrange(256) for _ in range(3)], random.randrange(1000)))
def ply(name, points):
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
    head += "".join("property double %s\n" % p for p in "xyz") + "".join("property float n%s\n" % p for p in "xyz")
    head += "".join("property uchar %s\n" % c for c in ("red", "green", "blue")) + "end_header\n"
    open("in/" + name, "wb").write(head.encode() + b"".join(struct.pack("<3d3f3B", *p, *n, *c) for p, n, c in points))
xyz = [scaled("cartesian" + a, 1e-3, -2500, 2500) for a in "XYZ"]
rest = [single("nor:normal" + a) for a in "XYZ"] + [whole("color" + c, 0, 255) for c in ("Red", "Green", "Blue")] + [whole("intensity", 0, 999)]
rows = [[*p, *n, *c, i] for p, n, c, i in ball]
ply("ball.ply", [(p, n, c) for p, n, c, i in ball])
e57("in/ball.e57", [(xyz + rest, rows, "")])
e57("in/small.e57", [(xyz + rest, rows, "")], most=77)
# a quarter turn around z, and moved: in the world the same ball; half of the points in each of two scans
turn = ('<pose type="Structure"><rotation type="Structure"><w type="Float">%r</w><x type="Float"/><y type="Float"/><z type="Float">%r</z></rotation>'
        '<translation type="Structure"><x type="Float">10</x><y type="Float">-4</y><z type="Float"/></translation></pose>' % (math.sqrt(0.5), math.sqrt(0.5)))
def back(v, moved): # what the pose brings to v
    x, y, z = (v[0] - 10, v[1] + 4, v[2]) if moved else v
    return [y, -x, z]
wide = [scaled("cartesian" + a, 1e-3, -15000, 15000, offset=0.5) for a in "XYZ"]
shift = [[round(v, 3) for v in back(row[:3], True)] for row in rows]
turned = [[*p, *back(row[3:6], False), *row[6:]] for p, row in zip(shift, rows)]
e57("in/two.e57", [(xyz + rest, rows[:1500], ""), (wide + rest, turned[1500:], turn)])
# spherical coordinates as doubles, and every tenth point invalid
round_fields = [{"name": "spherical" + n, "type": "Float"} for n in ("Range", "Azimuth", "Elevation")] + rest + [whole("sphericalInvalidState", 0, 2)]
def spherical(p):
    r = math.sqrt(sum(v * v for v in p))
    return [r, math.atan2(p[1], p[0]), math.asin(p[2] / r)]
states = [k % 10 == 3 for k in range(len(rows))]
e57("in/round.e57", [(round_fields, [[*spherical(r[:3]), *r[3:], 1 + (k & 1) if s else 0] for k, (r, s) in enumerate(zip(rows, states))], "")])
ply("valid.ply", [(p, n, c) for (p, n, c, i), s in zip(ball, states) if not s])
e57("in/text.e57", [(xyz + [{"name": "remark", "type": "String"}], [], "")])
e57("in/flat.e57", [(xyz[:2], [r[:2] for r in rows], "")])
e57("in/sum.e57", [(xyz + rest, rows, "")], damage=lambda whole: whole[:5000] + bytes([whole[5000] ^ 1]) + whole[5001:])
e57("in/cut.e57", [(xyz + rest, rows, "")], damage=lambda whole: whole[:-2048])
P
python3 in/make.py || exit 1
same() { # E57 PLY PIXELS
    isorender in/$1.e57 a.png --resolution 160x160 --camera iso --quiet --json=a.json "${@:4}" || exit 1
    isorender in/$2.ply b.png --resolution 160x160 --camera iso --quiet --json=b.json "${@:4}" || exit 1
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
expect(max(abs(p - q) for p, q in zip(a["bounds_world"], b["bounds_world"])) < 1e-4, sys.argv, a["bounds_world"], b["bounds_world"])
differ = sum(max(abs(x - y) for x, y in zip(p, q)) > 2 for p, q in zip(Png("a.png").pixels(), Png("b.png").pixels()))
expect(differ <= int(sys.argv[3]), sys.argv, differ)' "$@" || exit 1
}
same ball ball 0
same small ball 0
same two ball 60
same round valid 60
isorender in/round.e57 --info 2>&1 | grep -q 'note: 300 points without a return are left out' || exit 1
isorender in/two.e57 --info 2>&1 | grep -q 'note: 2 scans, in the coordinates of the world' || exit 1
isorender in/ball.e57 --info | grep -q 'intensity: 0 .. 99[0-9]' || exit 1
isorender in/ball.e57 --info | grep -q 'bounds .* m$' || exit 1
cp in/ball.e57 in/no_extension
isorender in/no_extension c.png --quiet --resolution 40x40 || exit 1
isorender_refuses 3 'in/text.e57: its points have texts (remark), which are not read' in/text.e57
isorender_refuses 3 'in/flat.e57: a scan without coordinates' in/flat.e57
isorender_refuses 3 'in/sum.e57: damaged: the checksum of a page is wrong' in/sum.e57
isorender_refuses 3 'in/cut.e57: truncated' in/cut.e57
