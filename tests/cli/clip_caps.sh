# caps show the volume as it is, trilinear, where a plane cuts the solid, and nowhere else; nested solids cap in order; slices;
# the same by exact and raycast, opaque and through layers; what makes no sense is refused
python3 - <<'P'
from check import *
volume("in/v.mha", (22, 20, 18), lambda x, y, z: 900 - 9 * ((x - 10) ** 2 + (y - 9) ** 2 + 1.5 * (z - 8) ** 2) + 40 * (x % 3),
       header="ElementSpacing = 1.5 1 2\nOffset = 5 -7 3\n")
P
options="in/v.mha --quiet --resolution 120x100 --samples 1 --isovalue 300 --window 500,900"
for zoom in 1 3 16; do
    clip="--clip 21,2,19:-.3,-.7,.4 --zoom $zoom"
    isorender $options $clip --cap slice cap$zoom.png --json=cap$zoom.json
    isorender $options $clip --cap slice --method raycast truth$zoom.png
    isorender $options $clip --cap slice --opacity .4 layers$zoom.png
    isorender $options $clip --cap slice --opacity .4 --method raycast layerstruth$zoom.png
done
isorender in/v.mha --quiet --resolution 120x100 --isovalue 300,600,850 --color red,lime,blue --clip 'y<2' --cap surface nested.png
isorender in/v.mha --quiet --resolution 120x100 --isovalue 300,850 --color red,blue --clip 'y<2@1' --cap surface whole.png
two="${options/ --isovalue 300/} --isovalue 300,600 --color red,lime --clip 21,4,19:-.3,-.7,.4@1 --clip y<-1@2"
isorender $two --cap slice two.png
isorender $two --cap slice twotruth.png --method raycast
isorender $options --slice y=2 --opacity 0 --color red slice.png --orthographic
isorender $options --slice y=2 --opacity 0 --color red slicetruth.png --orthographic --method raycast
for cpu in generic avx2 avx512; do
    ISO_CPU=$cpu isorender $options --clip 'y<2' --cap slice:viridis --slice z=20 --samples 4 $cpu.png --threads ${#cpu}
    cmp generic.png $cpu.png
done
isorender $options --clip 'y<2' --cap slice plain.png
isorender $options --clip 'y<2' --cap slice --color-bar=T2 bar.png # at the right, the rest as without it
isorender $options --clip 'y<2' --cap slice --color-bar=T1 other.png
if cmp -s bar.png plain.png || cmp -s bar.png other.png; then echo "no bar or no title"; exit 1; fi
isorender_refuses 2 "2 names for 1 bar" $options --clip 'y<2' --cap slice '--color-bar=a;b'
mkdir moved
cp cap3.png moved/
refuses 3 'moved/in/v.mha: cannot read: No such file' isorender --again moved/cap3.png x.png
isorender --again cap3.png again.png --quiet
cmp cap3.png again.png
python3 - <<'P'
import math
from check import *

def sub(a, b): return [x - y for x, y in zip(a, b)]
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def cross(a, b): return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
def unit(a): return [x / math.sqrt(dot(a, a)) for x in a]
def value(x, y, z): return 900 - 9 * ((x - 10) ** 2 + (y - 9) ** 2 + 1.5 * (z - 8) ** 2) + 40 * (x % 3)

def trilinear(p):
    index = [(p[0] - 5) / 1.5, p[1] + 7, (p[2] - 3) / 2]
    if not all(0 <= i <= n for i, n in zip(index, (21, 19, 17))):
        return -1e9
    low = [min(int(i), n) for i, n in zip(index, (20, 18, 16))]
    sum = 0
    for corner in range(8):
        weight, at = 1, []
        for axis in range(3):
            part, up = index[axis] - low[axis], corner >> axis & 1
            weight *= part if up else 1 - part
            at.append(low[axis] + up)
        sum += weight * value(*at)
    return sum

def same(one, other):
    p, q = Png(one).pixels(), Png(other).pixels()
    off = sum(max(abs(i - j) for i, j in zip(m, n)) > 2 for m, n in zip(p, q))
    expect(off <= 2, one, "differs in", off, "pixels")

normal, point = unit([-.3, -.7, .4]), [21, 2, 19]
for zoom in (1, 3, 16):
    a, camera = Png("cap%d.png" % zoom), report("cap%d.json" % zoom)["camera"]
    eye, forward = camera["position"], unit(sub(camera["focal_point"], camera["position"]))
    right = unit(cross(forward, camera["view_up"]))
    down, focal = cross(forward, right), 50 / math.tan(math.radians(camera["view_angle"]) / 2)
    caps = bad = 0
    for y in range(100):
        for x in range(120):
            u, v = (x + .5 - 60) / focal, (y + .5 - 50) / focal
            ray = [f + u * r + v * d for f, r, d in zip(forward, right, down)]
            t = dot(normal, sub(point, eye)) / dot(normal, ray)
            here = trilinear([e + t * r for e, r in zip(eye, ray)])
            if here < 300:
                continue
            caps += 1
            gray = min(max((here - 50) / 900, 0), 1) * 255
            bad += any(abs(a.rows[y][x][k] - gray) > 1 for k in range(3))
    expect(caps > 1000 and bad == 0, zoom, bad, "of", caps, "pixels of the cap are wrong")
    same("cap%d.png" % zoom, "truth%d.png" % zoom)
    same("layers%d.png" % zoom, "layerstruth%d.png" % zoom)
same("two.png", "twotruth.png")
seen = [max(range(3), key=lambda k: p[k]) for p in Png("nested.png").rows[55] if p[:3] != (255, 255, 255)]
order = [c for i, c in enumerate(seen) if i == 0 or seen[i - 1] != c]
expect(order == [0, 1, 2, 1, 0], order)
middle = Png("whole.png").rows[50]
expect(any(p[2] > p[0] for p in middle), "the inner surface is not whole in front of the cap")
red = sum(p[0] > 200 and p[1] < 50 for p in Png("slice.png").pixels())
expect(100 < red < 1000, red, "pixels of outlines")
expect(Png("slice.png").rows == Png("slicetruth.png").rows, "slices differ")
P
# lines are along the outlines of a cap and of a slice, which stay as they are
for what in "--clip y<2 --cap slice" "--slice y=0"; do
    isorender in/v.mha plain.png $what --resolution 80x80 --samples 1 --quiet
    isorender in/v.mha lines.png $what --resolution 80x80 --samples 1 --outline --quiet
    python3 -c 'from check import *
plain, lines = (list(Png(n + ".png").pixels()) for n in ("plain", "lines"))
ink = sum(p != q for p, q in zip(plain, lines))
seen = sum(p[:3] != (255, 255, 255) for p in plain)
expect(100 < ink < .3 * seen, ink, "of", seen, sys.argv)' "$what"
done
refuses 2 "needs --clip" isorender in/v.mha bad.png --cap slice
refuses 2 "no colormap .rainbow." isorender in/v.mha bad.png --clip 'y<2' --cap slice:rainbow
refuses 2 "is for --slice" isorender in/v.mha bad.png --clip 'y<2' --cap red --window 3,4
refuses 2 "not above 0" isorender in/v.mha bad.png --clip 'y<2' --cap slice --window 3,0
for plane in 'y<2' y= box:1,2,3,4,5,6 keep:y=2 y=2@1 1,2,3:0,0,0; do
    refuses 2 "is not a plane" isorender in/v.mha bad.png --slice "$plane"
done
