# a file of 3-D Gaussians, as trainers write them, is recognised and drawn as what it is; what does not go with it is refused.
python3 - <<'P'
import math, random, struct
random.seed(8)
NAMES = ("x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 " + " ".join("f_rest_%d" % i for i in range(45))
         + " opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3").split()
def write(path, gaussians):
    """Writes (place, colour 0 .. 1, opacity 0 .. 1, standard deviations, quaternion w x y z) as 3DGS does."""
    with open(path, "wb") as f:
        f.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(gaussians)
                 + "".join("property float %s\n" % n for n in NAMES) + "end_header\n").encode())
        for place, color, opacity, sizes, turn in gaussians:
            numbers = [*place, 0, 0, 0, *((c - 0.5) / 0.28209479177387814 for c in color), *[0.25] * 45,
                       math.log(opacity / (1 - opacity)), *(math.log(s) for s in sizes), *turn]
            f.write(struct.pack("<%df" % len(numbers), *numbers))
def ball(count):
    for _ in range(count):
        v = [random.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        yield ([10 * x / length for x in v], [random.random() for _ in range(3)], random.uniform(0.1, 0.95),
               [random.uniform(0.05, 1.5) for _ in range(3)], [random.gauss(0, 1) for _ in range(4)])
write("in/ball.ply", list(ball(800)))
# one, twice as wide along z as along x, above a level that the bounds reach down to
far = [([x, 0, z], [0, 0, 0], 1e-4, [1e-3] * 3, [1, 0, 0, 0]) for x in (-10, 10) for z in (-10, 10)]
write("in/one.ply", far + [([0, 0, 0], [1, 0.25, 0], 0.75, [1, 1, 2], [1, 0, 0, 0])])
# the same, lying down by a quarter turn about y
write("in/turned.ply", far + [([0, 0, 0], [1, 0.25, 0], 0.75, [2, 1, 1], [math.sqrt(0.5), 0, math.sqrt(0.5), 0])])
P
same() { isorender "${@:2}" "$1.png" --quiet --resolution 150x150 --json="$1.json"; }
same a in/ball.ply
same b in/ball.ply --threads 1 --method gaussians
ISO_CPU=generic same c in/ball.ply
same discs in/ball.ply --method discs
same one in/one.ply --mm-per-pixel 0.2 --background 0000FF
same turned in/turned.ply --mm-per-pixel 0.2 --background 0000FF
same none in/one.ply --mm-per-pixel 0.2 --background none
same cut in/ball.ply --clip 1,0,0:1,.3,.2
same rest in/ball.ply --clip keep:1,0,0:1,.3,.2
cat >in/bar.swc <<'P'
1 1 -8 -40 0 3 -1
2 1 8 -40 0 3 1
P
same bar in/ball.ply --lines in/bar.swc --line-color red --samples 4
isorender --info in/ball.ply >info
isorender in/ball.ply --no-image --points in/points.ply --quiet
python3 - <<'P'
import math
from check import *
a, b, c, discs = (report(n + ".json") for n in ("a", "b", "c", "discs"))
expect(a["method"] == "gaussians" and discs["method"] == "discs", a["method"], discs["method"])
expect(a["image"]["hash"] == b["image"]["hash"] == c["image"]["hash"] != discs["image"]["hash"])
expect(a["primitives"]["estimated_normals"] == 0 < discs["primitives"]["estimated_normals"], a["primitives"])
expect(a["primitives"]["points"] == 800 and a["image"]["layers"]["mean"] > 2, a)
expect(report("bar.json")["image"]["covered"] > a["image"]["covered"])
# against the formula: 5 pixels a mm, 0.3 square pixels of low-pass, background blue
for name, size in (("one", (1, 2)), ("turned", (1, 2))):
    rows = Png(name + ".png").rows
    for y in range(150):
        for x in range(150):
            q = sum(((p - 74.5) ** 2) / ((s * 5) ** 2 + 0.3) for p, s in zip((x, y), size))
            alpha = 0.75 * math.exp(-q / 2)
            alpha = alpha if alpha >= 1 / 255 else 0
            wanted = [255 * alpha, 0.25 * 255 * alpha, 255 * (1 - alpha)]
            expect(all(abs(g - w) < 1.6 for g, w in zip(rows[y][x], wanted)), name, x, y, rows[y][x], wanted)
middle = Png("none.png").rows[75][75]
expect(abs(middle[3] - 0.75 * 255) < 3 and middle[0] > 250, middle)
whole, cut, rest = ([p[:3] != (255, 255, 255) for p in Png(n + ".png").pixels()] for n in ("a", "cut", "rest"))
expect(sum(cut) < 0.9 * sum(whole) and sum(rest) < 0.9 * sum(whole), sum(whole), sum(cut), sum(rest))
expect(sum(w != (c or r) for w, c, r in zip(whole, cut, rest)) < 20, "what --clip leaves and takes is not the whole")
info = open("info").read()
expect("as 3-D Gaussians" in info and "opacity     0.1" in info and "points      800" in info, info)
expect("f_rest" not in info, info)
head = open("in/points.ply", "rb").read(400)
expect(b"element vertex 800" in head and b"property uchar red" in head, head)
P
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >in/plain.ply
isorender_refuses 2 "in/plain.ply: --method gaussians draws files of 3-D Gaussians only" in/plain.ply --method gaussians
isorender_refuses 2 "in/ball.ply: holds 3-D Gaussians: --aov is for opaque discs, which --method discs draws" in/ball.ply --aov a.exr
isorender_refuses 2 "--radius is for opaque discs" in/ball.ply --radius 2
isorender_refuses 2 "--shading edl is for opaque discs" in/ball.ply --shading edl
isorender_refuses 2 "in/ball.ply: holds points, not a volume: --method exact needs a volume" in/ball.ply --method exact
isorender_refuses 2 "cannot be combined with translucent surfaces" in/ball.ply --method gaussians --opacity 0.5
isorender_refuses 2 "cannot be combined with OpenGL" in/ball.ply --method gaussians --backend egl
isorender_refuses 2 "draws files of 3-D Gaussians only" scene:sphere:16 --method gaussians
head -c 20000 in/ball.ply >in/short.ply
isorender_refuses 3 "in/short.ply: truncated" in/short.ply
