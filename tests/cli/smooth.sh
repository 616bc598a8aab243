# smooth surfaces: exact draws what raycast draws of the same spline, other than the trilinear surface; layers and clips are
# those of the spline; the same bytes for all threads and kernels, from a scene file too; --json says which filter
python3 - <<'P'
from check import *
import math, random
random.seed(3)
ball("in/ball.mha")
volume("in/noise.mha", (20, 20, 20), lambda x, y, z: int(90 + 60 * math.tanh(6 - math.dist((x, y, z), (9.6, 9.3, 9.8)))
                                                          + random.gauss(0, 4)), "MET_UCHAR", "B")
P
how="--resolution 200x200 --samples 1 --quiet"
draw() { isorender $1 $how "${@:3}" "$2.png" && isorender $1 $how "${@:3}" --method raycast "$2-truth.png"; }
for filter in cubic interpolating; do
    draw "in/ball.mha --isovalue 500" ball-$filter --reconstruction-filter $filter
    draw "in/noise.mha --isovalue 90" noise-$filter --reconstruction-filter $filter --zoom 2
done
draw "in/noise.mha --isovalue 90" clip --reconstruction-filter cubic --clip 'x>10'
draw "in/noise.mha --isovalue 90" layers --reconstruction-filter cubic --opacity .4
isorender in/noise.mha $how --isovalue 90 --zoom 2 linear.png
for cpu in generic avx2 avx512; do
    ISO_CPU=$cpu isorender in/noise.mha $how --isovalue 90 --zoom 2 --reconstruction-filter cubic --threads ${#cpu} $cpu.png
    cmp generic.png $cpu.png
done
isorender --again noise-cubic.png again.png --quiet --json again.json
cmp noise-cubic.png again.png
python3 - <<'P'
from check import *
expect(report("again.json")["reconstruction_filter"] == "cubic", "not said")
differ = lambda a, b, by: sum(max(abs(x - y) for x, y in zip(p, q)) > by for p, q in zip(Png(a).pixels(), Png(b).pixels()))
for name in ("ball-cubic", "ball-interpolating", "noise-cubic", "noise-interpolating", "clip"):
    off = differ(name + ".png", name + "-truth.png", 2)
    expect(off <= 60, name, "differs in", off, "pixels")
expect(differ("noise-cubic.png", "generic.png", 0) == 0, "kernels draw something else")
off = differ("layers.png", "layers-truth.png", 12)
expect(off <= 600, "layers differ in", off, "pixels")
expect(differ("noise-cubic.png", "linear.png", 8) > 2000, "not smooth")
P
