# Scans of PTX: each in the world by its matrix, with intensities and colours, without points that have no return.
python3 - <<'P'
import math
from check import *
golden = math.pi * (3 - math.sqrt(5))
sphere = [(math.cos(golden * i) * math.sqrt(1 - (1 - (2 * i + 1) / 900) ** 2), math.sin(golden * i) * math.sqrt(1 - (1 - (2 * i + 1) / 900) ** 2),
           1 - (2 * i + 1) / 900) for i in range(900)]
turn = [(0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1)] # x to y, y to -x

def ptx(name, scans, colors=True):
    rows = []
    for points, m in scans:
        rows += ["30", str(len(points) // 30), "0 0 0", "1 0 0", "0 1 0", "0 0 1"] + [" ".join(map(str, r)) for r in m]
        rows += ["%.9f %.9f %.9f %.3f" % (*p, abs(p[2])) + (" %d 40 90" % (127 + 120 * p[0]) if colors else "") for p in points]
    open("in/" + name, "w").write("\n".join(rows) + "\n")

identity = [[int(i == k) for k in range(4)] for i in range(4)]
ptx("plain.ptx", [(sphere, identity)])
ptx("turned.ptx", [(sphere, turn)])
ptx("two.ptx", [(sphere[:450], turn), (sphere[450:] + [(0, 0, 0)] * 30, turn)])
ptx("grey.ptx", [(sphere, identity)], colors=False)
def xyz(name, points):
    head = "x y z intensity red green blue\n"
    open("in/" + name, "w").write(head + "".join("%.9f %.9f %.9f %.3f %d 40 90\n" % (*q, abs(p[2]), 127 + 120 * p[0]) for p, q in points))
xyz("plain.xyz", [(p, p) for p in sphere])
xyz("turned.xyz", [(p, (5 - p[1], 6 + p[0], 7 + p[2])) for p in sphere])
P
draw() { isorender "in/$1" "$1.png" --resolution 60x60 --quiet --json="$1.json"; }
for file in plain.ptx turned.ptx two.ptx plain.xyz turned.xyz grey.ptx; do draw $file; done
python3 -c 'from check import *
for a, b in (("plain.ptx", "plain.xyz"), ("turned.ptx", "turned.xyz"), ("two.ptx", "turned.xyz")):
    near = sum(abs(p - q) > 2 for row, other in zip(Png(a + ".png").rows, Png(b + ".png").rows) for s, t in zip(row, other) for p, q in zip(s, t))
    expect(near < 50, a, b, near)
    boxes = [report(name + ".json")["bounds_world"] for name in (a, b)]
    expect(max(abs(p - q) for p, q in zip(*boxes)) < 1e-5, a, b, boxes)'
isorender in/two.ptx --info 2>&1 | grep -q '30 points without a return are left out'
isorender in/grey.ptx --info 2>&1 | grep -q intensity

head -n 500 in/plain.ptx >in/cut.ptx
isorender_refuses 3 'in/cut.ptx: truncated: ' in/cut.ptx
sed '2s/30/3000000/' in/plain.ptx >in/many.ptx
isorender_refuses 3 'in/many.ptx: truncated: it promises 90000000 points' in/many.ptx
sed '8s/.*/0 1 0/' in/plain.ptx >in/matrix.ptx
isorender_refuses 3 'in/matrix.ptx: row 8: not four rows of the scanner and four of a matrix' in/matrix.ptx
sed '15s/ 40 90//' in/plain.ptx >in/five.ptx
isorender_refuses 3 'in/five.ptx: row 15: not a point' in/five.ptx
sed '15s/ [0-9]* 40 90//' in/plain.ptx >in/four.ptx
isorender_refuses 3 'in/four.ptx: row 15: some points have colours, others none' in/four.ptx
