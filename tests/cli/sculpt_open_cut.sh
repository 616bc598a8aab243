# A mesh that its volume's border cut, and one that lacks triangles and is inside out.
isorender scene:ct:64 --no-image --crop 10,40,25,60,20,60 --mesh in/cut.stl --quiet
isosculpt --open in/cut.stl --headless --voxel-size 0.5 --output o.stl --json=a.json 2>note.txt
isosculpt --open in/cut.stl --headless --voxel-size 0.5 --output again.stl --json=b.json --threads 3 --quiet 2>quiet.txt
cmp o.stl again.stl
test ! -s quiet.txt
grep -q "^isosculpt: in/cut.stl: the mesh has [0-9]* open edges: [0-9]* loops capped" note.txt
test "$(grep -vc ": wrote o.stl: [0-9]* triangles$" note.txt)" -eq 1
python3 - <<'P'
import struct
from check import *
def facets(path):
    data = open(path, "rb").read()
    return [struct.unpack_from("<9f", data, 84 + 50 * i + 12) for i in range(struct.unpack_from("<I", data, 80)[0])]
def volume(path):
    total = 0
    for a, b, c, d, e, f, g, h, i in facets(path):
        total += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return total / 6
a, b = report("a.json"), report("b.json")
expect(a["opened_mesh"] == b["opened_mesh"], a, b)
m = a["opened_mesh"]
expect(m["open_edges"] > 500 and m["loops_capped"] > 40 and m["holes_closed"] == 0 and not m["inside_out"], m)
expect(abs(volume("o.stl") / m["volume"] - 1) < 0.01, volume("o.stl"), m)
kept = [t for n, t in enumerate(facets("o.stl")) if n % 5000 != 7]
with open("in/holes.stl", "wb") as out:
    out.write(bytes(80) + struct.pack("<I", len(kept)))
    for t in kept: out.write(struct.pack("<12fH", 0, 0, 0, *t[0:3], *t[6:9], *t[3:6], 0))
P
isosculpt --open in/holes.stl --headless --voxel-size 0.5 --json=c.json --output c.stl 2>note.txt
grep -q "holes of up to .* mm filled; it is inside out" note.txt
python3 - <<'P'
from check import *
a, c = report("a.json"), report("c.json")
m = c["opened_mesh"]
expect(m["holes_closed"] > 5 and m["open_edges"] == 3 * m["holes_closed"] and m["inside_out"], m)
expect(abs(m["volume"] / a["opened_mesh"]["volume"] - 1) < 0.01, a["opened_mesh"], m)
P
