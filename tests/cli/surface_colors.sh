# surfaces coloured by a volume of another resolution and place, by distance, curvature, depth and normals: the same by exact and
# raycast, opaque and translucent, under clips, with every number of threads; meshes get the colours; scenes find the files again
python3 - <<'P'
from check import *
volume("in/v.mha", (26, 24, 22), lambda x, y, z: 900 - 6 * ((x - 12) ** 2 + (y - 11) ** 2 + 1.5 * (z - 10) ** 2) + 30 * (x % 3),
       header="ElementSpacing = 1.5 1 2\nOffset = 5 -7 3\n")
volume("in/data.mha", (9, 12, 15), lambda x, y, z: 100 * x + 37 * y * y - 20 * z + 5 * x * y * z,
       header="ElementSpacing = 5 2.5 3\nOffset = 2 -9 1\n")
volume("in/half.mha", (5, 12, 15), lambda x, y, z: 100 * x + 37 * y, header="ElementSpacing = 5 2.5 3\nOffset = 2 -9 1\n")
volume("in/far.mha", (4, 4, 4), lambda x, y, z: x, header="Offset = 500 500 500\n")
open("in/red.txt", "w").write("# low to high\n000000\n#FF0000\n")
P
options="in/v.mha --quiet --resolution 100x90 --samples 1 --isovalue 300"
number=0
for by in in/data.mha distance:scene:sphere:32 distance:in/data.mha:3000 curvature depth normal; do
    for zoom in 1 16; do
        number=$((number + 1))
        isorender $options --zoom $zoom --surface-color-by $by e$number.png --json=e$number.json
        isorender $options --zoom $zoom --surface-color-by $by r$number.png --method raycast
        isorender $options --zoom $zoom --surface-color-by $by --opacity .4 le$number.png
        isorender $options --zoom $zoom --surface-color-by $by --opacity .4 lr$number.png --method raycast
    done
done
isorender $options --surface-color-by in/data.mha m.png --method mesh
isorender $options --surface-color-by in/data.mha --clip 'y<2' --cap slice ce.png
isorender $options --surface-color-by in/data.mha --clip 'y<2' --cap slice cr.png --method raycast
isorender $options --surface-color-by in/data.mha --occlusion --outline oe.png
isorender $options --isovalue 600 --opacity .3,1 --surface-color-by in/data.mha@2 --surface-color-by curvature@1 \
    --colormap in/red.txt --colormap gray --range 0,3000 two.png --color-bar --json=two.json
for cpu in generic avx2 avx512; do
    ISO_CPU=$cpu isorender $options --samples 4 --opacity .5 --surface-color-by distance:in/data.mha:3000 $cpu.png --threads ${#cpu}
    cmp generic.png $cpu.png
done
isorender $options --surface-color-by in/data.mha --color-bar --range 0,3000 --colormap in/red.txt bar.png --mesh bar.ply
isorender $options --surface-color-by normal n.png --mesh n.obj
isorender --again bar.png again.png --quiet
cmp bar.png again.png
mkdir moved && mv bar.png in/data.mha in/red.txt moved/ && cp in/v.mha moved/
isorender --again moved/bar.png moved.png --quiet
mv moved/data.mha moved/red.txt in/
isorender in/v.mha --isovalue 300 half.png --resolution 60x60 --surface-color-by in/half.mha 2>half
grep -q "note: .*% of the surface lies outside the volume" half
isorender in/v.mha --isovalue 300 far.png --resolution 60x60 --surface-color-by in/far.mha 2>far
grep -q "note: .*no values where the surface is" far
python3 - <<'P'
from check import *

def apart(one, other, most, allowed):
    p, q = Png(one).pixels(), Png(other).pixels()
    off = [max(abs(i - j) for i, j in zip(m, n)) for m, n in zip(p, q)]
    expect(sum(d > most for d in off) <= allowed, one, other, sum(d > most for d in off), "pixels, most", max(off))

for number in range(1, 13):
    apart("e%d.png" % number, "r%d.png" % number, 2, 2)
    apart("le%d.png" % number, "lr%d.png" % number, 2, 2)
apart("ce.png", "cr.png", 2, 2)
apart("m.png", "r1.png", 40, 300)
expect(Png("again.png").rows == Png("moved.png").rows, "files beside the scene are not found")
colors = report("two.json")["surface_colors"]
expect([c["by"] for c in colors] == ["volume", "curvature"], colors)
expect(colors[0]["range"] == [0, 3000] and colors[1]["range"] == [0, 3000], colors)
expect(colors[0]["colormap"] == "in/red.txt" and colors[1]["colormap"] == "gray", colors)
signed = report("e3.json")["surface_colors"][0]
expect(signed["range"][0] == -signed["range"][1] and signed["colormap"] == "coolwarm", signed)

# the vertices of the mesh have the colours of the data at their places
def data(p):
    index = [(p[0] - 2) / 5, (p[1] + 9) / 2.5, (p[2] - 1) / 3]
    low = [min(int(i), n) for i, n in zip(index, (7, 10, 13))]
    sum = 0
    for corner in range(8):
        weight, at = 1, []
        for axis in range(3):
            part, up = index[axis] - low[axis], corner >> axis & 1
            weight *= part if up else 1 - part
            at.append(low[axis] + up)
        x, y, z = at
        sum += weight * (100 * x + 37 * y * y - 20 * z + 5 * x * y * z)
    return sum
import struct
raw = open("bar.ply", "rb").read()
head, body = raw.split(b"end_header\n", 1)
count = int(head.split(b"element vertex ")[1].split()[0])
expect(b"property uchar red" in head, head)
for i in range(0, count, 7):
    v = struct.unpack_from("<6f3B", body, 27 * i)
    wanted = 255 * min(max(data(v[:3]) / 3000, 0), 1)
    expect(abs(v[6] - wanted) <= 1 and v[7:] == (0, 0), i, v, wanted)
vertex = next(l.split() for l in open("n.obj") if l.startswith("v "))
expect(len(vertex) == 7, vertex)
gray = sum(abs(p[0] - p[1]) < 3 and abs(p[1] - p[2]) < 3 and p[0] < 200 for p in Png("far.png").pixels())
expect(gray > 200, gray)
P
refuses 3 "nothing.mha" isorender in/v.mha bad.png --isovalue 300 --surface-color-by nothing.mha
refuses 3 "nothing.mha" isorender in/v.mha bad.png --isovalue 300 --surface-color-by distance:nothing.mha
refuses 2 "did you mean viridis" isorender in/v.mha bad.png --isovalue 300 --surface-color-by curvature --colormap virdis
refuses 2 "smaller one first" isorender in/v.mha bad.png --isovalue 300 --surface-color-by curvature --range 3,1
refuses 2 "there is no @3" isorender in/v.mha bad.png --isovalue 300 --surface-color-by curvature@3
refuses 2 "both colour @1" isorender in/v.mha bad.png --isovalue 300 --surface-color-by curvature --surface-color-by depth@1
refuses 2 "of translucent surfaces: that needs exact or raycast" isorender in/v.mha bad.png --isovalue 300 --surface-color-by depth --opacity .5 --method splats
refuses 2 "cannot be combined with --part" isorender in/v.mha --surface-color-by depth --part 1/2 -o bad.isokeys
printf '000000\nwhat\n' >in/bad.txt
refuses 3 "row 2, 'what', is no colour" isorender in/v.mha bad.png --isovalue 300 --surface-color-by depth --colormap in/bad.txt
printf 'ff0000\n' >in/one.txt
refuses 3 "two colours at least" isorender in/v.mha bad.png --isovalue 300 --surface-color-by depth --colormap in/one.txt
