if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
# which glyph, line and segment, and triangle is seen, as the files count them; seen from the front along +y, 4 pixels a mm
python3 - <<'P'
from check import *
ball("in/ball.mha")
# the second sphere is behind the first; the third has no radius and is left out, but counted
open("in/dots.csv", "w").write("x,y,z,radius\n-10,-50,0,2\n-10,-40,0,2\n0,-50,0,0\n10,-50,0,2\n")
# two lines: the first has no segment that can be drawn, the second has two
open("in/lines.obj", "w").write("v 0 -60 -15\nv 0 -60 -15\nv -15 -60 10\nv 0 -60 10\nv 15 -60 10\nl 1 2\nl 3 4 5\n")
# the first triangle has no area
open("in/mesh.obj", "w").write("v -15 -70 -5\nv 15 -70 -5\nv 0 -70 -12\nf 1 1 2\nf 1 2 3\n")
P
render() { # NAME INPUT..
    local name=$1
    shift
    isorender "$@" --lines in/lines.obj --tube-radius 1 --glyphs in/dots.csv --surface in/mesh.obj --aov $name.exr --no-image \
        --orthographic --mm-per-pixel 0.25 --camera-position 0,-500,0 --camera-focal-point 0,0,0 --resolution 160x120 --quiet
}
render alone
render ball in/ball.mha --isovalue 500
render two in/ball.mha --isovalue 500 --isovalue 600 --opacity 0.5
render four in/ball.mha --isovalue 500 --samples 4
render one in/ball.mha --isovalue 500 --threads 1
cmp one.exr ball.exr
isorender in/ball.mha --isovalue 500 --isovalue 600 --aov both.exr --no-image --quiet
isorender in/ball.mha --isovalue 500 --aov plain.exr --no-image --quiet
python3 - <<'P'
from check import *
NAMES = ["A", "N.X", "N.Y", "N.Z", "Z", "id.element", "id.segment", "id.surface"]
for name, first in (("alone", 1), ("ball", 2), ("two", 3), ("four", 2)):
    e = Exr(name + ".exr")
    expect(e.names == NAMES + ["layers"] * (name == "two"), name, e.names)
    at = lambda x, z: tuple(e.planes["id." + n][int(60 - 4 * z) * 160 + int(80 + 4 * x)]
                            for n in ("surface", "element", "segment"))
    expect(at(-10, 10) == (first, 2, 1), name, "first segment", at(-10, 10))
    expect(at(7, 10) == (first, 2, 2), name, "second segment", at(7, 10))
    expect(at(-10, 0) == (first + 1, 1, 0), name, "first sphere", at(-10, 0))
    expect(at(10, 0) == (first + 1, 4, 0), name, "last sphere", at(10, 0))
    expect(at(0, -8) == (first + 2, 2, 0), name, "triangle", at(0, -8))
    expect(at(0, 14.5) == (0, 0, 0), name, "beside", at(0, 14.5))
    expect(at(14, 14) == ((0 if first == 1 else 1), 0, 0), name, "ball", at(14, 14))
    for a, s, n, k in zip(e.planes["A"], e.planes["id.surface"], e.planes["id.element"], e.planes["id.segment"]):
        expect((a > 0) == (s > 0) and (n > 0) == (s >= first) and (k > 0) == (s == first), name, a, s, n, k)
both, plain = Exr("both.exr"), Exr("plain.exr")
expect(both.names == NAMES and set(both.planes["id.surface"]) == {0, 1}, both.names)
expect(plain.names == NAMES[:5], plain.names)
P
