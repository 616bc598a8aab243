# Meshes for printing: smoothed, with fewer triangles, hollow; always closed.
python3 - <<'P'
from check import *
import random
random.seed(1)
ball("in/ball.mha", side=40, radius=14.0)
volume("in/noisy.mha", (40, 40, 40), lambda x, y, z: 15 - ((x - 20) ** 2 + (y - 20) ** 2 + (z - 20) ** 2) ** 0.5 + random.uniform(-0.4, 0.4))
P
cat >in/look.py <<'P'
import struct
def mesh(path):
    data = open(path, "rb").read()
    count, = struct.unpack_from("<I", data, 80)
    return [[struct.unpack_from("<3f", data, 84 + 50 * i + 12 + 12 * k) for k in range(3)] for i in range(count)]
P
export PYTHONPATH=$PYTHONPATH:$PWD/in
out="--no-image --quiet"
closed() { python3 -c 'from check import *; m = report("'$1'")["mesh"]; expect(m["open_edges"] == 0 and m.get("crowded_edges", 0) == 0, m)'; }
isorender in/noisy.mha --isovalue 0 --mesh n.stl --json=n.json $out
isorender in/noisy.mha --isovalue 0 --mesh s.stl --smooth-mesh 20 --json=s.json $out
python3 - <<'P'
from check import *
from look import *
def roughness(path):
    r = [sum((c - 20) ** 2 for c in p) ** 0.5 for t in mesh(path) for p in t]
    mean = sum(r) / len(r)
    return mean, (sum((x - mean) ** 2 for x in r) / len(r)) ** 0.5
(a, rough), (b, smooth) = roughness("n.stl"), roughness("s.stl")
expect(smooth < 0.5 * rough and abs(a - b) < 0.1, a, rough, b, smooth)
expect(abs(report("s.json")["mesh"]["volume"] / report("n.json")["mesh"]["volume"] - 1) < 0.01, "volume")
P
closed s.json
if isorender in/ball.mha --isovalue 500 --mesh d.stl --decimate 10% --json=d.json $out 2>said; then
    isorender in/ball.mha --isovalue 500 --mesh m.stl --decimate 0.1 --json=m.json $out
    # what may be meant otherwise is said: a distance for a share, a picture of the mesh as it was
    isorender in/ball.mha shown.png --isovalue 500 --method mesh --mesh n.stl --decimate 0.1 2>said
    grep -q "note: --decimate 0.1 is a distance, 0.1 mm; 10% is a share of the triangles" said
    grep -q "note: the picture shows the mesh before --decimate.*isorender n.stl" said
    isorender in/ball.mha shown.png --isovalue 500 --mesh n.stl --decimate 10% 2>said
    ! grep "note:" said
    isorender in/ball.mha --isovalue 500 --mesh f.stl --json=f.json $out
    for name in d m f; do closed $name.json; done
    python3 - <<'P'
from check import *
from look import *
counts = {n: len(mesh(n + ".stl")) for n in "dmf"}
expect(abs(counts["d"] / counts["f"] - 0.1) < 0.01 and counts["m"] < 0.5 * counts["f"], counts)
for name, most in (("m", 0.12), ("d", 0.5)):
    # the middles of triangles lie deepest below the ball
    worst = max(abs(sum((sum(p[i] for p in t) / 3 - 19.5) ** 2 for i in range(3)) ** 0.5 - 14) for t in mesh(name + ".stl"))
    expect(worst < most, name, worst)
P
else
    grep -q "built without meshoptimizer" said
fi
# a wall of 2 mm in a solid of 1 mm voxels: both faces where they should be
isorender in/ball.mha --isovalue 500 --hollow 2 --mesh h.stl --json=h.json $out
closed h.json
python3 - <<'P'
from check import *
from look import *
m = report("h.json")["mesh"]
expect(m["pieces"] == 2, m)
r = [sum((c - 19.5) ** 2 for c in p) ** 0.5 for t in mesh("h.stl") for p in t]
outer, inner = [x for x in r if x > 13], [x for x in r if x <= 13]
expect(max(abs(x - 14) for x in outer) < 0.1 and max(abs(x - 12) for x in inner) < 0.1, min(outer), max(inner))
wall = sum(outer) / len(outer) - sum(inner) / len(inner)
expect(abs(wall - 2) < 0.05, wall)
want = 4 / 3 * 3.14159265 * (14 ** 3 - 12 ** 3)
expect(abs(m["volume"] / want - 1) < 0.01, m["volume"], want)
P
# holes through it make one piece with a handle more for each hole beyond the first
isorender in/ball.mha --isovalue 500 --hollow 2 --drain 5 --mesh p.stl --json=p.json $out
closed p.json
python3 - <<'P'
from check import *
from look import *
m = report("p.json")["mesh"]
expect(m["pieces"] == 1 and m["euler"] == 0, m)
near = [p for t in mesh("p.stl") for p in t if p[2] > 20 and ((p[0] - 19.5) ** 2 + (p[1] - 19.5) ** 2) ** 0.5 < 4]
widths = [((p[0] - 19.5) ** 2 + (p[1] - 19.5) ** 2) ** 0.5 for p in near]
expect(widths and abs(min(widths) - 2.5) < 0.3, min(widths, default=None))
P
# what a volume cuts off is closed, and hollow; a plane shows the wall; bytes do not depend on threads
isorender in/ball.mha --isovalue 100 --hollow 1.5 --mesh c.stl --json=c.json $out --threads 3
closed c.json
isorender in/ball.mha --isovalue 100 --hollow 1.5 --mesh c1.stl $out --threads 1
cmp c.stl c1.stl
isorender in/ball.mha wall.png --isovalue 500 --hollow 2 --clip 'y<19.5' --cap red --resolution 80x80 --fit box --quiet
python3 - <<'P'
from check import *
p = Png("wall.png")
red = sum(1 for row in p.rows for q in row if q[0] > 90 and q[1] < 60)
expect(200 < red < 1500, red)
P
if command -v admesh >/dev/null; then
    for file in s h p c; do
        admesh $file.stl >said
        grep -qE "^Total disconnected facets *: *0 *0 *$" said || { cat said; exit 1; }
        for what in "Degenerate facets" "Edges fixed" "Facets removed" "Facets added" "Facets reversed" "Backwards edges"; do
            grep -qE "^$what *: *0 *$" said || { cat said; exit 1; }
        done
    done
fi
refuses 6 "nowhere thicker than two walls of 20 mm" isorender in/ball.mha --isovalue 500 --hollow 20 --mesh bad.stl $out
refuses 2 "it needs --hollow MM" isorender in/ball.mha --isovalue 500 --drain 2 --mesh bad.stl $out
refuses 2 "it needs --mesh FILE" isorender in/ball.mha bad.png --isovalue 500 --decimate 10% --quiet
refuses 2 "neither a share of the triangles, such as 10%, nor mm" isorender in/ball.mha --isovalue 500 --decimate 200% --mesh bad.stl $out
