# Three solids: 216, 27 and one voxel of 2 mm3. --json counts parts of the solid, and pieces of its mesh.
python3 - <<'P'
from check import *
def value(x, y, z):
    large = 2 <= x < 8 and 2 <= y < 8 and 2 <= z < 8
    small = 12 <= x < 15 and 12 <= y < 15 and 12 <= z < 15
    return 200.0 if large or small or (x, y, z) == (4, 15, 4) else 20.0
volume("in/three.mha", (18, 18, 18), value, header="ElementSpacing = 1 1 2\n")
P
run() { isorender in/three.mha --isovalue 100 "$@"; }
run --no-image --mesh all.ply --json >all.json
run --no-image --mesh one.ply --largest --json >one.json 2>one.err
run --no-image --mesh two.ply --largest=2 --json >two.json 2>two.err
run --no-image --mesh min.ply --min-size 54 --json >min.json 2>/dev/null
run --no-image --points p.ply --min-size 54.1 --json >points.json 2>/dev/null
for method in exact points discs pullpush mesh raycast; do
    isorender in/three.mha --isovalue 100,150 --method $method --largest --resolution 60x60 --json=$method.json --quiet $method.png
    run --method $method --largest --resolution 60x60 one-$method.png --quiet
done
grep -q 'kept 1 of 3 parts of the solid, dropped 2 with 11.5 % of its volume' one.err
grep -q 'kept 2 of 3 parts of the solid, dropped 1 ' two.err
python3 - <<'P'
from check import *
def parts(name): return report(name)["solid_parts"]
expect("solid_parts" not in report("all.json"), "not asked for")
expect(report("all.json")["mesh"]["pieces"] == 3, report("all.json")["mesh"])
one = parts("one.json")
expect((one["kept"], one["dropped"], one["kept_volume"], one["dropped_volume"]) == (1, 2, 432, 56), one)
expect(abs(one["dropped_share"] - 28 / 244) < 1e-12, one)
expect(report("one.json")["mesh"]["pieces"] == 1 and report("two.json")["mesh"]["pieces"] == 2, "pieces of meshes")
expect(open("min.ply", "rb").read() == open("two.ply", "rb").read(), "54 mm3 are two voxels' worth")
expect(parts("points.json")["kept"] == 1, parts("points.json"))
several = report("exact.json")["surfaces"]
expect([s["isovalue"] for s in several] == [100, 150] and all(s["solid_parts"]["kept"] == 1 for s in several), several)
for method in ("exact", "points", "discs", "pullpush", "mesh", "raycast"):
    a = Png("one-%s.png" % method)
    expect(a.width == 60, method)
P

# The two volumes of --json, of voxels and inside the triangles, against a ball's: radius 0.4 x 64 mm.
isorender scene:sphere:64 --no-image --mesh ball.ply --largest --json >ball.json 2>/dev/null
python3 - <<'P'
from check import *
from math import pi
ball = report("ball.json")
wanted = 4 / 3 * pi * 25.6 ** 3
voxels, inside = ball["solid_parts"]["kept_volume"], ball["mesh"]["volume"]
expect(abs(voxels / wanted - 1) < 0.002 and abs(inside / wanted - 1) < 0.002, (voxels, inside, wanted))
P
