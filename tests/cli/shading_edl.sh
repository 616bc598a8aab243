# eye-dome lighting: another picture of the same samples, the same for threads and instruction sets, in strips and for any method.
python3 -c 'from check import *; ball("in/ball.mha")'
draw() { isorender "${@:2}" "$1.png" --quiet --resolution 120x120 --json="$1.json"; }
draw phong in/ball.mha --isovalue 500
draw edl in/ball.mha --isovalue 500 --shading edl
draw same in/ball.mha --isovalue 500 --shading edl --threads 1
ISO_CPU=generic draw generic in/ball.mha --isovalue 500 --shading edl
draw fine in/ball.mha --isovalue 500 --shading edl --samples 16
isorender in/ball.mha --isovalue 500 --points in/p.ply --no-image --quiet
draw points in/p.ply --shading edl
python3 - <<'P'
from check import *
phong, edl, same, generic, fine, points = (report(n + ".json") for n in "phong edl same generic fine points".split())
expect(phong["image"]["covered"] == edl["image"]["covered"], phong["image"], edl["image"])
expect(edl["image"]["hash"] == same["image"]["hash"] == generic["image"]["hash"] != phong["image"]["hash"])
for name in ("edl", "fine", "points"):
    rows = Png(name + ".png").rows
    middle, rim = rows[60][60], rows[60][15]
    # the middle faces the eye and has nothing before it; towards the rim the neighbours stand out
    expect(middle[0] > 0.93 * 0xD9 and sum(rim[:3]) < 0.85 * sum(middle[:3]), name, middle, rim)
P
isorender_refuses 2 "--shading edl is of opaque surfaces: it cannot be combined with --ior" in/ball.mha --shading edl --ior 1.5
isorender_refuses 2 "it cannot be combined with --opacity below 1" in/ball.mha --shading edl --opacity 0.5
