# what is flat and edge-on from the front is looked at from a side that shows it; what a camera is given for is not
python3 - <<'P'
def spill(name, rows):
    open(name, "w").write("".join("%g %g %g\n" % row for row in rows))
spill("in/wall.xyz", [(.01 * (i * 7 % 10), i, k) for i in range(40) for k in range(30)])
def plate(name, points):
    open(name, "w").write("".join("v %g %g %g\n" % p for p in points) + "f 1 2 3 4\n")
plate("in/lying.obj", [(0, 0, 0), (10, 0, 0), (10, 6, 0), (0, 6, 0)])
plate("in/across.obj", [(0, 0, 0), (0, 10, 0), (0, 10, 6), (0, 0, 6)])
plate("in/facing.obj", [(0, 0, 0), (10, 0, 0), (10, 0, 6), (0, 0, 6)])
# obliquely: seen from the edge from the front, and one of them from iso as well; turned and inclined, none is
plate("in/oblique.obj", [(0, 0, 0), (0, 10, 0), (6, 10, 6), (6, 0, 6)])
plate("in/leaning.obj", [(0, 0, 0), (0, 10, 0), (-6, 10, 6), (-6, 0, 6)])
plate("in/turned.obj", [(0, 0, 0), (8, 6, 0), (8, 6, 5), (0, 0, 5)])
plate("in/inclined.obj", [(0, 0, 0), (9, 0, 0), (9, 5, 4), (0, 5, 4)])
spill("in/ramp.xyz", [(.7 * i, k, .7 * i + .01 * (i * 7 % 10)) for i in range(60) for k in range(40)])
# a thick plate is none
spill("in/slab.xyz", [(.7 * (i + j), k, .7 * (i - j)) for i in range(40) for j in range(4) for k in range(30)])
P
isorender in/wall.xyz wall.png --background none --resolution 100x100 --quiet
for name in lying across facing oblique leaning turned inclined; do
    isorender --surface in/$name.obj $name.png --background none --resolution 100x100 --quiet
done
for name in ramp slab; do
    isorender in/$name.xyz $name.png --background none --resolution 100x100 --quiet
    isorender in/$name.xyz ${name}_front.png --camera front --background none --resolution 100x100 --quiet
done
for name in turned inclined; do
    isorender --surface in/$name.obj ${name}_front.png --camera front --background none --resolution 100x100 --quiet
done
isorender --surface in/facing.obj front.png --camera front --background none --resolution 100x100 --quiet
python3 - <<'P'
from check import *
for name in ("wall", "lying", "across", "oblique", "leaning", "ramp"):
    covered = sum(pixel[3] > 127 for row in Png(name + ".png").rows for pixel in row)
    expect(covered > 1500, name, covered)
expect(Png("facing.png").rows == Png("front.png").rows, "another camera")
for name in ("turned", "inclined", "slab"):
    expect(Png(name + ".png").rows == Png(name + "_front.png").rows, name)
P
code=0
isorender --surface in/across.obj edge.png --camera front --quiet 2>said || code=$?
[ $code -eq 6 ]
rm -f said
