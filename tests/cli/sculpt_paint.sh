# A coloured bear: strokes get colours by --edit, and the mesh, the level set and isorender's pictures have them; without colours the outputs are as ever.
bear="$volumes/bear.strokes"
isosculpt --replay "$bear" --headless --quiet --edit 1-31:color=#8c5a32 --edit 7:color=#201814 --mesh brown.ply \
    --output brown.vdb --save-strokes brown.strokes
isosculpt --replay brown.strokes --headless --quiet --mesh again.ply
cmp brown.ply again.ply
isosculpt --replay "$bear" --headless --quiet --mesh plain.ply --output plain.vdb
isosculpt --replay brown.strokes --headless --quiet --edit 1-31:color=none --mesh none.ply
cmp plain.ply none.ply
isosculpt --replay brown.strokes --headless --quiet --output points.ply
isorender brown.strokes --color CE8E70 --points drawn-points.ply --no-image --quiet
# a coloured mesh, points and level set are opened with their colours, which further strokes keep and stroke files remember
isosculpt --open brown.ply --voxel-size 0.6 --headless --quiet --mesh of-mesh.ply --output of-mesh.vdb
isosculpt --open points.ply --voxel-size 0.6 --headless --quiet --mesh of-points.ply
isosculpt --open brown.vdb --headless --quiet --mesh of-vdb.ply
isosculpt --open of-mesh.vdb --headless --quiet --mesh of-mesh-vdb.ply
for type in obj glb 3mf; do isosculpt --replay brown.strokes --headless --quiet --mesh brown.$type; done
for type in glb 3mf; do isosculpt --open brown.$type --voxel-size 0.6 --headless --quiet --mesh of-$type.ply; done
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
for name in "points.ply", "drawn-points.ply":
    data = open(name, "rb").read()
    head, body = data.split(b"end_header\n", 1)
    expect(b"property uchar red" in head, head)
    found = [tuple(body[at + 28:at + 31]) for at in range(0, len(body), 31)]
    expect(len(found) * 31 == len(body) and sum(c == (0x8c, 0x5a, 0x32) for c in found) > 0.5 * len(found), name)
def shares(name):
    data = open(name, "rb").read()
    head, body = data.split(b"end_header\n", 1)
    expect(b"property uchar red" in head, name, head)
    count = int(head.split(b"element vertex ")[1].split()[0])
    found = [tuple(body[at + 24:at + 27]) for at in range(0, 27 * count, 27)]
    near = lambda color: sum(max(abs(a - b) for a, b in zip(c, color)) <= 12 for c in found) / count
    return [near(color) for color in ((0x8c, 0x5a, 0x32), (0x20, 0x18, 0x14), (206, 142, 112))]
wanted = shares("brown.ply")
for name in "of-mesh.ply", "of-points.ply", "of-vdb.ply", "of-mesh-vdb.ply", "of-glb.ply", "of-3mf.ply":
    expect(all(abs(a - b) < 0.02 and b > 0 for a, b in zip(wanted, shares(name))), name, wanted, shares(name))
vertex = next(line for line in open("brown.obj") if line.startswith("v "))
expect(len(vertex.split()) == 7, vertex)
P
# isorender draws strokes with their paint: a sample has the light of the plain bear, in one of its colours or between them
for color in 8C5A32 201814 CE8E70; do
    isorender plain.vdb --color $color --samples 1 --resolution 300x300 -o plain-$color.png --quiet
done
isorender brown.strokes --color CE8E70 --samples 1 --resolution 300x300 -o brown.png --mesh drawn.ply --quiet
isorender brown.strokes --color CE8E70 --samples 1 --resolution 300x300 --method discs -o discs.png --quiet
isorender brown.vdb --samples 1 --resolution 300x300 -o level-set.png --mesh level-set.ply --quiet
isorender brown.vdb --color CE8E70 --samples 1 --resolution 300x300 -o without.png --quiet
isorender brown.strokes --opacity 0.5 --method splats --resolution 300x300 -o glassy.png 2>message
grep -q "note: drawn without its paint: --method splats" message
python3 - <<'P'
from check import *
plain = [Png("plain-%s.png" % name).pixels() for name in ("8C5A32", "201814", "CE8E70")]
solid = [i for i in range(len(plain[0])) if plain[0][i] != plain[2][i]]
drawn = Png("brown.png").pixels()
counts = [sum(drawn[i] == colored[i] for i in solid) for colored in plain]
expect(counts[0] > 0.7 * len(solid) and counts[1] > 50 and counts[2] > 0.05 * len(solid), counts, len(solid))
expect(all(min(c[i][k] for c in plain) <= drawn[i][k] <= max(c[i][k] for c in plain) for i in solid for k in range(3)),
       "colours that are none between those painted")
expect(all(p[0] - p[2] < 45 for p in Png("glassy.png").pixels()), "brown splats")
expect(Png("without.png").pixels() == plain[2], "--color is instead of the colours of a .vdb")
level_set = Png("level-set.png").pixels()
off = sorted(max(abs(a - b) for a, b in zip(level_set[i], drawn[i])) for i in solid)
expect(off[-1] <= 2, "the .vdb is drawn in the colours of the strokes", off[-20:])
discs = Png("discs.png").pixels()
near = sum(max(abs(a - b) for a, b in zip(discs[i], drawn[i])) <= 12 for i in solid)
expect(near > 0.9 * len(solid), "discs", near, len(solid))
body = [open(name, "rb").read().split(b"end_header\n", 1)[1] for name in ("drawn.ply", "brown.ply")]
expect(body[0] == body[1], "isorender's mesh has the colours of isosculpt's")
P
code=0
isosculpt --replay "$bear" --headless --edit 1:color=ochreish --mesh no.ply 2>message || code=$?
[ "$code" = 2 ] && grep -q "color: 'ochreish'" message && [ ! -e no.ply ]
