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
P
isorender in/wall.xyz wall.png --background none --resolution 100x100 --quiet
for name in lying across facing; do
    isorender --surface in/$name.obj $name.png --background none --resolution 100x100 --quiet
done
isorender --surface in/facing.obj front.png --camera front --background none --resolution 100x100 --quiet
python3 - <<'P'
from check import *
for name in ("wall", "lying", "across"):
    covered = sum(pixel[3] > 127 for row in Png(name + ".png").rows for pixel in row)
    expect(covered > 1500, name, covered)
expect(Png("facing.png").rows == Png("front.png").rows, "another camera")
P
code=0
isorender --surface in/across.obj edge.png --camera front --quiet 2>said || code=$?
[ $code -eq 6 ]
rm -f said
