# Meshes are drawn in the colours of their vertices (.ply, .obj): one colour is that of --surface-color, two are mixed between.
cat >make.py <<'P'
from check import *
corners = [(0, 0, 0), (40, 0, 0), (40, 0, 20), (0, 0, 20)] # faces the front
faces = [(0, 1, 2), (0, 2, 3)]

def ply(name, kind, names, colors):
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "".join("property %s %s\n" % (kind, n) for n in names)
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    rows = ["%g %g %g %s\n" % (*p, " ".join("%g" % v for v in c)) for p, c in zip(corners, colors)]
    open(name, "w").write(head + "".join(rows) + "".join("3 %d %d %d\n" % f for f in faces))

def obj(name, colors):
    rows = ["v %g %g %g %s\n" % (*p, " ".join("%.9g" % v for v in c)) for p, c in zip(corners, colors)]
    open(name, "w").write("".join(rows) + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces))

RGB, one = ("red", "green", "blue"), (192, 128, 64)
ply("plain.ply", "uchar", (), [()] * 4)
ply("bytes.ply", "uchar", RGB, [one] * 4)
ply("diffuse.ply", "uchar", ("diffuse_red", "diffuse_green", "diffuse_blue"), [one] * 4)
ply("floats.ply", "float", RGB, [[v / 255 for v in one]] * 4)
ply("large.ply", "float", RGB, [(192, 128, 1)] * 4) # as bytes: 1 is nearly black
obj("rows.obj", [[v / 255 for v in one]] * 4)
obj("some.obj", [[v / 255 for v in one]] * 3 + [()])
ply("two.ply", "uchar", RGB, [(255, 0, 0), (0, 0, 255), (0, 0, 255), (255, 0, 0)])
P
python3 make.py
draw() { isorender --surface "$1" "$2.png" --camera front --resolution 90x50 --samples 1 --quiet --json="$2.json" "${@:3}"; }
same() { python3 -c 'from check import *
a, b = (report(n + ".json")["image"]["hash"] for n in sys.argv[1:3])
expect((a == b) == (sys.argv[3] == "yes"), sys.argv)' "$@"; }
draw plain.ply plain
draw plain.ply given --surface-color c08040
for file in bytes.ply diffuse.ply floats.ply rows.obj; do
    draw $file own
    same own given yes
done
same own plain no
draw some.obj own # not all vertices have one
same own plain yes
draw large.ply own
draw plain.ply given --surface-color c08001
same own given yes
draw bytes.ply own --surface-color gold
draw plain.ply given --surface-color gold
same own given yes
for method in mesh raycast; do
    isorender scene:sphere:16 $method.png --surface two.ply --method $method --camera front --resolution 90x50 --quiet
done
draw two.ply two
python3 -c 'from check import *
row = [p for p in Png("two.png").rows[25] if p[:3] != (255, 255, 255)]
expect(len(row) > 40, len(row))
shares = [p[0] / (p[0] + p[2]) for p in row] # of red; the light is the same everywhere but for its highlight
expect(shares[0] > .9 and shares[-1] < .1, shares[0], shares[-1])
expect(all(a >= b - .02 for a, b in zip(shares, shares[1:])), shares)
middle = shares[len(shares) // 2]
expect(.4 < middle < .6, middle)'
