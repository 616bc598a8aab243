# --lines of a mesh: branches become tubes, leaves ribbons, the rest stays triangles; branches that join; bad meshes
python3 - <<'P'
import math


def ring(x, z, radius, sides):
    return [(x + radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides), z) for i in range(sides)]


def off(name, vertices, faces):
    with open(name, "w") as file:
        file.write("OFF\n%d %d 0\n" % (len(vertices), len(faces)))
        file.writelines("%.6f %.6f %.6f\n" % v for v in vertices)
        file.writelines("3 %d %d %d\n" % f for f in faces)


def shift(faces, by):
    return [tuple(i + by for i in face) for face in faces]


def tube(x):  # of six sides, 9 rings, open
    vertices = [v for k in range(9) for v in ring(x, 3 * k, 1, 6)]
    faces = [f for k in range(8) for i in range(6)
             for f in ((6 * k + i, 6 * k + (i + 1) % 6, 6 * k + 6 + (i + 1) % 6), (6 * k + i, 6 * k + 6 + (i + 1) % 6, 6 * k + 6 + i))]
    return vertices, faces


LEAF = [(0, 0, 10), (-1, 0, 12), (1, 0, 12), (-.8, 0, 14), (.8, 0, 14), (0, 0, 17)], [(0, 2, 1), (1, 2, 4), (1, 4, 3), (3, 4, 5)]
CUBE = ([(x, y, z) for x in (4, 8) for y in (0, 4) for z in (0, 4)],
        [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
off("in/tube.off", *tube(0))
off("in/cube.off", *CUBE)
vertices, faces = tube(-8)
for more in tube(-4), LEAF, CUBE:
    faces += shift(more[1], len(vertices))
    vertices += more[0]
off("in/all.off", vertices, faces)
open("in/tube.obj", "w").write("v -0 0 0\nv 0 0 24\nl 1 2\n")
# a trunk with a branch on each side, as lines
swc, last = [], -1
for k in range(11):
    swc.append((0, 0, 2 * k, 1.5, last))
    last = len(swc)
for side in -1, 1:
    last = 11
    for k in range(1, 9):
        swc.append((1.2 * side * k, 0, 20 + 1.6 * k, 1, last))
        last = len(swc)
open("in/fork.swc", "w").writelines("%d 2 %g %g %g %g %d\n" % (i + 1, *row) for i, row in enumerate(swc))
P
view="--camera-position 0,-90,12 --camera-focal-point 0,0,12 --resolution 200x200 --samples 1"
isorender --lines in/tube.off tube.png --caps flat $view --line-color coral --json=tube.json 2>/dev/null
isorender --lines in/tube.obj line.png --tube-radius 1 --caps flat $view --line-color coral --quiet
isocompare images line.png tube.png --json --quiet >tube_metrics.json # the line that the mesh was made of
isorender --lines in/all.off all.png $view --json=all.json 2>notes
grep -q "note: in/all.off: 1 of 4 pieces are not made of thin branches and stay triangles" notes ||
    grep -q "note: 1 of 4 pieces are not made of thin branches and stay triangles" notes
isorender --lines in/all.off two.png $view --threads 1 --quiet
cmp all.png two.png
isorender --lines in/all.off styled.png $view --line-style line --json=styled.json --quiet
isorender --lines in/all.off pyramid.png $view --method pullpush --quiet
refuses 6 "in/cube.off: not made of thin branches or leaves: it is as thick as long; --surface draws its triangles" \
    isorender --lines in/cube.off bad.png
refuses 2 "in/all.off: --every is not for lines of a mesh" isorender --lines in/all.off bad.png --every 2
# branches that join, in a mesh of Marching Cubes
isosculpt --open in/fork.swc --voxel-size 0.4 --headless --mesh in/fork.ply -q
isorender --lines in/fork.ply fork.png $view --json=fork.json --quiet
isorender --lines in/fork.swc known.png $view --json=known.json --quiet
isocompare images known.png fork.png --pixels-per-voxel 1 --json --quiet >fork_metrics.json
python3 - <<'P'
from check import *
tube, = report("tube.json")["objects"]
metrics = report("tube_metrics.json")["metrics"]
expect(metrics["psnr"] == "inf" or metrics["psnr"] > 50, metrics)
expect(tube["format"] == "mesh" and tube["lines"] == 1 and tube["vertices"] == 9 and tube["mesh_triangles"] == 96, tube)
tubes, ribbons, rest = report("all.json")["objects"]
expect(tubes["lines"] == 2 and ribbons["lines"] == 1 and ribbons["vertices"] == 4 and rest["triangles"] == 12, tubes, ribbons, rest)
expect(tubes["samples"] and ribbons["samples"] and {tubes["path"], rest["path"]} == {"in/all.off"}, tubes, ribbons)
expect(0 < report("styled.json")["objects"][0]["samples"] < tubes["samples"] / 2, "lines are thin")
fork, = report("fork.json")["objects"]
expect(fork["lines"] == 2, fork)  # one goes through, one begins on it
metrics = report("fork_metrics.json")["metrics"]
expect(metrics["iou"] > 0.93 and metrics["dilation_max"] <= 4, metrics)
P
# vertices that are left out: the outlines of dense lines move by no more than half a pixel
python3 - <<'P'
import math
with open("in/dense.obj", "w") as file:
    for k in range(40):
        for i in range(500):
            a = i / 25
            file.write("v %.5f %.5f %.5f\n" % (k - 20 + .4 * math.cos(a), .4 * math.sin(a), i / 20 - 6))
        file.write("l " + " ".join(str(500 * k + i + 1) for i in range(500)) + "\n")
P
for style in tube ribbon; do
    dense="--lines in/dense.obj --line-style $style --tube-radius 0.15 --method pullpush --zoom 0.6 --resolution 256x256 --samples 1 --quiet"
    isorender $dense kept.png
    isorender $dense dropped.png --line-drop-pixels 0.5
    isorender $dense dropped2.png --line-drop-pixels 0.5 --threads 1
    isorender $dense coarse.png --line-drop-pixels 8
    cmp dropped.png dropped2.png
    if cmp -s kept.png dropped.png || cmp -s dropped.png coarse.png; then exit 1; fi
    isocompare images kept.png dropped.png --pixels-per-voxel 1 --json --quiet >dropped.json
    python3 - <<'P'
from check import *
metrics = report("dropped.json")["metrics"]
expect(metrics["iou"] > 0.98 and metrics["dilation_max"] <= 1, metrics)
P
done
