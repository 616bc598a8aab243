# Whatever is cut by the border is closed with --closed; admesh, where there is one, finds nothing to mend.
python3 - <<'P'
from check import *
import random
random.seed(3)
volume("in/noise.mha", (13, 9, 11), lambda x, y, z: float(random.randrange(4)))
volume("in/odd.mha", (9, 9, 9), lambda x, y, z: float("nan") if (x + y) % 5 == 0 else 100.0 - x * z,
       header="ElementSpacing = 0.5 0.7 1.25\nOffset = -30 40 1000\nTransformMatrix = 0 1 0 1 0 0 0 0 1\n")
ball("in/ball.mha")
P
check() {
    isorender "$@" --no-image --json=in/open.json --mesh in/open.stl --quiet
    isorender "$@" --no-image --json=in/closed.json --mesh in/closed.stl --closed --quiet
    isorender "$@" --json=in/picture.json in/picture.png --resolution 40x40 --closed --quiet
    python3 - "$1" <<'P'
from check import *
import struct
def triangles(path):
    data = open(path, "rb").read()
    return [[data[i + 12 + 12 * k:i + 24 + 12 * k] for k in range(3)] for i in range(84, len(data), 50)]
def sides(path):
    count = {}
    for t in triangles(path):
        for k in range(3):
            count[t[k], t[(k + 1) % 3]] = count.get((t[k], t[(k + 1) % 3]), 0) + 1
    return count
first, second = report("in/open.json"), report("in/closed.json")
expect(first["mesh"]["open_edges"] > 0 and first["mesh"]["volume"] is None, sys.argv[1], first["mesh"])
mesh = second["mesh"]
expect(mesh["open_edges"] == 0 and mesh["crowded_edges"] == 0 and mesh["volume"] > 0, sys.argv[1], mesh)
found = sides("in/closed.stl")
expect(all(n == 1 and found.get((b, a)) == 1 for (a, b), n in found.items()), "each edge exactly twice")
vertices = len({a for a, b in found})
expect(mesh["euler"] == vertices - len(found) // 2 + second["primitives"]["triangles"], "Euler number", mesh, vertices)
drawn = report("in/picture.json")
spacing = max(second["volume"]["spacing"])
for key in ("bounds_local", "bounds_world"):
    expect(all(abs(a - b) <= 2e-3 * spacing + 1e-4 for a, b in zip(second[key], drawn[key])), key, second[key], drawn[key])
crop = second["volume"].get("crop") or [v for n in second["volume"]["dims"] for v in (0, n - 1)]
for i, v in enumerate(second["bounds_local"]):
    edge = crop[i] * second["volume"]["spacing"][i // 2]
    expect(v >= edge if i % 2 == 0 else v <= edge, "beyond the border", second["bounds_local"], crop)
    if sys.argv[1].startswith("scene:gyroid"): expect(v == edge, "ends at the border", second["bounds_local"], crop)
P
    command -v admesh >/dev/null || return 0
    admesh --exact in/closed.stl >in/admesh.txt
    grep -Eq 'Total disconnected facets +: +0 ' in/admesh.txt
    grep -Eq 'Degenerate facets +: +0$' in/admesh.txt
    grep -Eq 'Backwards edges +: +0$' in/admesh.txt
}
check scene:gyroid:32
check scene:gyroid:48 --crop 3,40,0,37,5,47
check scene:sphere:48 --crop 8,24,0,47,3,30
check in/ball.mha --isovalue 500 --crop 0,11,0,23,0,9
check in/noise.mha --isovalue 2
check in/noise.mha --isovalue 1.5
check in/odd.mha --isovalue 60
# A solid that ends before the border is the same with --closed, up to the vertices that are moved off voxels.
isorender in/ball.mha --isovalue 500 --no-image --mesh a.stl --json=a.json -q
isorender in/ball.mha --isovalue 500 --no-image --mesh b.stl --json=b.json -q --closed
python3 - <<'P'
from check import *
a, b = report("a.json")["mesh"], report("b.json")["mesh"]
expect(abs(a["volume"] - b["volume"]) < 1e-3 * a["volume"] and a["euler"] == b["euler"] == 2, a, b)
expect(abs(a["volume"] - 4 / 3 * 3.14159265 * 8 ** 3) < 0.02 * a["volume"], a)
P
