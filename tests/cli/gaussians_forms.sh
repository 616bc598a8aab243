# 3-D Gaussians in other forms than that of the first trainer: with two scales (flat), and packed as SuperSplat writes them.
python3 - <<'P'
import math, random, struct
random.seed(5)
COUNT, SH = 300, 0.28209479177387814
def plain(path, gaussians, scales=3):
    names = ("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2".split()[:7 + scales] + ["rot_%d" % i for i in range(4)])
    with open(path, "wb") as f:
        f.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(gaussians)
                 + "".join("property float %s\n" % n for n in names) + "end_header\n").encode())
        for place, scale, turn, color, opacity in gaussians:
            numbers = [*place, *((c - 0.5) / SH for c in color), math.log(opacity / (1 - opacity)), *scale[:scales], *turn]
            f.write(struct.pack("<%df" % len(numbers), *numbers))
# words of Gaussians, and what they mean in the ranges of their chunks of 256
def lerp(low, high, part):
    return low * (1 - part) + high * part
def triple(word, low, high):
    parts = ((word >> 21) / 2047, (word >> 11 & 1023) / 1023, (word & 2047) / 2047)
    return [lerp(a, b, p) for a, b, p in zip(low, high, parts)]
def rotation(word):
    three = [((word >> s & 1023) / 1023 - 0.5) * math.sqrt(2) for s in (20, 10, 0)]
    three.insert(word >> 30, math.sqrt(max(0, 1 - sum(v * v for v in three))))
    return three
chunks = [([-9, -9, -9], [0, 9, 9], [-3, -3, -3], [-1, 0, -1]), ([0, -9, -5], [9, 9, 9], [-3, -2, -3], [0, 0, -2])]
words, meant = [], []
for i in range(COUNT):
    turn = random.randrange(4) << 30
    for shift in (20, 10, 0): # numbers that the largest exceeds
        turn |= random.randrange(200, 824) << shift
    w = (random.randrange(1 << 32), turn, random.randrange(1 << 32), random.randrange(1 << 24) << 8 | random.randrange(8, 248))
    low, high, small, large = chunks[i // 256]
    words.append(w)
    meant.append((triple(w[0], low, high), triple(w[2], small, large), rotation(w[1]),
                  [(w[3] >> s & 255) / 255 for s in (24, 16, 8)], (w[3] & 255) / 255))
ranges = [p + a for p in ("min_", "max_") for a in "xyz"] + [p + a for p in ("min_scale_", "max_scale_") for a in "xyz"]
head = ("ply\nformat binary_little_endian 1.0\nelement chunk 2\n" + "".join("property float %s\n" % n for n in ranges)
        + "element vertex %d\n" % COUNT + "".join("property uint packed_%s\n" % n for n in ("position", "rotation", "scale", "color"))
        + "end_header\n").encode()
body = b"".join(struct.pack("<12f", *(v for part in c for v in part)) for c in chunks) + b"".join(struct.pack("<4I", *w) for w in words)
open("in/packed.ply", "wb").write(head + body)
open("in/cut.ply", "wb").write((head + body)[:-8])
open("in/chunks.ply", "wb").write(head.replace(b"chunk 2", b"chunk 1") + body)
plain("in/plain.ply", meant)
plain("in/flat.ply", meant, scales=2)
plain("in/thin.ply", [(p, [*s[:2], math.log(1e-6)], t, c, o) for p, s, t, c, o in meant])
P
for name in plain packed flat thin; do
    isorender in/$name.ply $name.png --quiet --resolution 120x120 --json=$name.json
done
isorender --info in/packed.ply | grep -q 'as 3-D Gaussians'
isorender in/packed.ply discs.png --quiet --method discs --resolution 100x100
python3 - <<'P'
from check import *
def apart(a, b):
    return max(abs(x - y) for p, q in zip(Png(a).pixels(), Png(b).pixels()) for x, y in zip(p, q))
expect(report("flat.json")["image"]["hash"] == report("thin.json")["image"]["hash"] != report("plain.json")["image"]["hash"], "flat")
expect(apart("packed.png", "plain.png") <= 2, "packed", apart("packed.png", "plain.png"))
P
isorender_refuses 3 "truncated" in/cut.ply
isorender_refuses 3 "1 chunks of 256 for 300 Gaussians" in/chunks.ply
