# A sculpture that the border of its grid cuts: the export says that its mesh is open, and --closed caps it there.
head="--replay $volumes/head.strokes --headless --voxel-size 1"
isosculpt $head --output open.stl --json=open.json 2>open.txt
isosculpt $head --output closed.stl --json=closed.json --closed 2>closed.txt
isosculpt $head --output a.vdb --mesh closed.ply --closed --quiet --threads 3 2>quiet.txt
isosculpt $head --output again.stl --quiet 2>>quiet.txt
isosculpt --replay $volumes/bear.strokes --headless --voxel-size 1 --output bear.stl 2>bear.txt
grep -q '^isosculpt: open.stl: [1-9][0-9]* open edges where the border of the grid cuts the solid: --closed caps it there$' open.txt
if grep -q 'open edges' closed.txt; then exit 1; fi
test ! -s quiet.txt
if grep -q 'open edges' bear.txt; then exit 1; fi
cmp open.stl again.stl
python3 - <<'P'
from check import *
open_mesh, closed = report("open.json")["mesh"], report("closed.json")["mesh"]
expect(open_mesh["open_edges"] > 100 and open_mesh["volume"] is None, open_mesh)
said = open("open.txt").read()
expect(" %d open edges " % open_mesh["open_edges"] in said, said, open_mesh)
expect(closed["open_edges"] == 0 and closed["crowded_edges"] == 0 and closed["volume"] > 0, closed)
import struct
data = open("closed.stl", "rb").read()
sides = {}
for i in range(84, len(data), 50):
    corner = [data[i + 12 + 12 * k:i + 24 + 12 * k] for k in range(3)]
    for k in range(3):
        side = corner[k], corner[(k + 1) % 3]
        sides[side] = sides.get(side, 0) + 1
expect(all(n == 1 and sides.get((b, a)) == 1 for (a, b), n in sides.items()), "each edge exactly twice")
grid = report("closed.json")
low, high = (-63.75, -63.75 + (grid["dims"][0] - 1) * grid["voxel_size"])
for i in range(84, len(data), 50):
    for v in struct.unpack_from("<9f", data, i + 12):
        expect(low - 2e-3 <= v <= high + 2e-3, "beyond the grid", v)
P
# Without a mesh there is nothing to close.
status=0
isosculpt $head --output b.vdb --closed 2>error.txt || status=$?
[ $status -eq 2 ]
grep -q -- '--closed is for meshes' error.txt
