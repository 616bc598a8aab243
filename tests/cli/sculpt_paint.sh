# A coloured bear: strokes get colours by --edit, and the mesh and the level set have them; without colours the outputs are as ever.
bear="$volumes/bear.strokes"
isosculpt --replay "$bear" --headless --quiet --edit 1-31:color=#8c5a32 --edit 7:color=#201814 --mesh brown.ply \
    --output brown.vdb --save-strokes brown.strokes
isosculpt --replay brown.strokes --headless --quiet --mesh again.ply
cmp brown.ply again.ply
isosculpt --replay "$bear" --headless --quiet --mesh plain.ply --output plain.vdb
isosculpt --replay brown.strokes --headless --quiet --edit 1-31:color=none --mesh none.ply
cmp plain.ply none.ply
for type in obj glb 3mf; do isosculpt --replay brown.strokes --headless --quiet --mesh brown.$type; done
isorender brown.vdb --info >info
isorender brown.vdb --grid Cd --info >colors 2>&1 || true
python3 - <<'P'
import struct
from check import *
def colors(name):
    data = open(name, "rb").read()
    head, body = data.split(b"end_header\n", 1)
    count = int(head.split(b"element vertex ")[1].split()[0])
    expect((b"property uchar red" in head) == (name == "brown.ply"), head)
    step = 27 if name == "brown.ply" else 24
    return [tuple(body[i * step + 24:i * step + 27]) for i in range(count)] if step == 27 else []
brown = colors("brown.ply")
colors("plain.ply")
expect(sum(c == (0x8c, 0x5a, 0x32) for c in brown) > 0.5 * len(brown), "most of the bear is brown")
expect(sum(c == (0x20, 0x18, 0x14) for c in brown) > 100, "its nose is black")
expect(sum(c == (206, 142, 112) for c in brown) > 100, "where nothing was drawn it has the surface's own colour")
expect(b"COLOR_0" in open("brown.glb", "rb").read(), "colours in .glb")
vertex = next(line for line in open("brown.obj") if line.startswith("v "))
expect(len(vertex.split()) == 7, vertex)
P
code=0
isosculpt --replay "$bear" --headless --edit 1:color=ochreish --mesh no.ply 2>message || code=$?
[ "$code" = 2 ] && grep -q "color: 'ochreish'" message && [ ! -e no.ply ]
