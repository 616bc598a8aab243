# instances of a model (--instances): the same picture as of one file with all their points, whatever the format, the
# rotation and the size; what is hidden or outside is left out and counted; refusals
python3 - <<'P'
import math, struct
from check import *

ball("in/ball.mha", side=20, radius=6.0)
PLACES = [(0, 0, 0, (0, 0, 0), 1), (20, -9, 4, (0, 0, 90), 0.8), (-21, 5, 2, (35, -50, 120), 1.5), (3, 25, -6, (0, 180, 0), 1.2)]


def quaternion(angles):
    s, c = zip(*((math.sin(math.radians(a) / 2), math.cos(math.radians(a) / 2)) for a in angles))
    return (s[0] * c[1] * c[2] - c[0] * s[1] * s[2], c[0] * s[1] * c[2] + s[0] * c[1] * s[2],
            c[0] * c[1] * s[2] - s[0] * s[1] * c[2], c[0] * c[1] * c[2] + s[0] * s[1] * s[2])


with open("in/angles.csv", "w") as file:
    file.write("x,y,z,rx,ry,rz,scale\n")
    for x, y, z, angles, scale in PLACES:
        file.write("%g,%g,%g,%g,%g,%g,%g\n" % (x, y, z, *angles, scale))
with open("in/quaternions.ply", "wb") as file:
    file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(PLACES) + b"".join(
        b"property float %s\n" % name for name in (b"x", b"y", b"z", b"qx", b"qy", b"qz", b"qw", b"scale")) + b"end_header\n")
    for x, y, z, angles, scale in PLACES:
        file.write(struct.pack("<8f", x, y, z, *(3 * q for q in quaternion(angles)), scale))
open("in/one.csv", "w").write("x,y,z\n0,0,0\n")
open("in/zeros.csv", "w").write("x,y,z,rz\n" + "".join("0,0,0,%d\n" % (30 * i) for i in range(12)))
# a row behind the first one, one beside the picture, one behind the eye
open("in/row.csv", "w").write("x,y,z,scale,red,green,blue\n0,0,0,1,255,0,0\n5.7,80,5.7,0.4,0,255,0\n900,0,0,1,0,0,255\n0,-900,0,1,0,0,255\n")
P
isorender in/ball.mha --isovalue 500 --points model.ply --no-image --quiet
same() { python3 -c "import sys; from check import *; expect(Png(sys.argv[1]).rows == Png(sys.argv[2]).rows, sys.argv)" "$1" "$2"; } # pixels
look="--resolution 120x90 --camera iso --quiet"

# one instance at the origin is the model itself
for model in "in/ball.mha --isovalue 500" model.ply "scene:gyroid:24"; do
    for method in discs splats; do
        isorender $model plain.png --method $method $look
        isorender $model placed.png --method $method $look --instances in/one.csv
        same plain.png placed.png
    done
done
isorender in/ball.mha plain.png --isovalue 500 --method discs --fit tight --samples 4 $look
isorender in/ball.mha placed.png --isovalue 500 --fit tight --samples 4 $look --instances in/one.csv --json=one.json
same plain.png placed.png

# all of them are the points of one file, placed by this script
python3 - <<'P'
import math, struct
from check import expect
data = open("model.ply", "rb").read()
at = data.index(b"end_header\n") + len(b"end_header\n")
head = data[:at].decode()
count = int(head.split("element vertex ")[1].split()[0])
expect([line.split()[1:] for line in head.splitlines() if line.startswith("property")] ==
       [["float", name] for name in "x y z nx ny nz radius".split()], head)
points = list(struct.iter_unpack("<7f", data[at:at + 28 * count]))


def matrix(angles):
    (sx, cx), (sy, cy), (sz, cz) = ((math.sin(math.radians(a)), math.cos(math.radians(a))) for a in angles)
    return ((cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx), (sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx),
            (-sy, cy * sx, cy * cx))


merged = []
for line in open("in/angles.csv").readlines()[1:]:
    x, y, z, rx, ry, rz, scale = map(float, line.split(","))
    m = matrix((rx, ry, rz))
    for p in points:
        at, normal = ([sum(row[k] * v[k] for k in range(3)) for row in m] for v in (p[:3], p[3:6]))
        merged.append((x + scale * at[0], y + scale * at[1], z + scale * at[2], *normal, scale * p[6]))
with open("merged.ply", "wb") as file:
    file.write(head.replace("element vertex %d" % count, "element vertex %d" % len(merged)).encode())
    for p in merged:
        file.write(struct.pack("<7f", *p))
P
look="$look --camera-position 90,-120,60 --camera-focal-point 10,10,10"
isorender merged.ply merged.png $look
isorender model.ply angles.png $look --instances in/angles.csv --json=angles.json
isorender model.ply quaternions.png $look --instances in/quaternions.ply
isorender model.ply detail.png $look --instances in/angles.csv --lod 1
isocompare images merged.png angles.png --fail-under psnr=43 >/dev/null
isocompare images angles.png quaternions.png --fail-under psnr=60 >/dev/null

# the same bytes for every number of threads, instruction set, and frame of a turntable
isorender model.ply one.png $look --instances in/angles.csv --threads 1
cmp angles.png one.png
for level in generic avx2; do
    ISO_CPU=$level isorender model.ply level.png $look --instances in/angles.csv
    cmp angles.png level.png
done
isorender model.ply turn_{n}.png $look --instances in/angles.csv --turntable 3 --json=turn.json
isorender model.ply turned.png --resolution 120x90 --quiet --instances in/angles.csv --json=turned.json \
    $(python3 -c 'import json; c = json.load(open("turn.json"))["camera"]; print("--camera-position %.17g,%.17g,%.17g --camera-focal-point %.17g,%.17g,%.17g --camera-view-up %.17g,%.17g,%.17g --azimuth 120" % (*c["position"], *c["focal_point"], *c["view_up"]))')
same turn_1.png turned.png

# colours; what is hidden, and what is outside
isorender in/ball.mha row.png --isovalue 500 --instances in/row.csv --camera front --camera-position 9.5,-60,9.5 \
    --camera-focal-point 9.5,0,9.5 --resolution 160x160 --quiet --json=row.json
isorender in/ball.mha all.png --isovalue 500 --instances in/row.csv --camera front --camera-position 9.5,-60,9.5 \
    --camera-focal-point 9.5,0,9.5 --resolution 160x160 --quiet --selection all --method discs
same row.png all.png
isorender in/ball.mha beside.png --isovalue 500 --instances in/one.csv --glyphs in/row.csv --glyph-radius 3 $look
isorender model.ply zeros.png $look --instances in/zeros.csv --json=zeros.json
isorender model.ply --info --instances in/angles.csv --quiet >info.txt
isorender in/ball.mha --isovalue 500 --no-image --json=only.json --instances in/angles.csv --quiet
python3 - <<'P'
import struct
from check import *
one, angles, row, turn = (report(name + ".json") for name in ("one", "angles", "row", "turn"))
expect(one["image"]["instances"]["drawn"] == 1 and one["method"] == "discs", one)
expect(angles["instances"]["count"] == 4 and angles["instances"]["scale"] == [float.fromhex("0x1.99999ap-1"), 1.5], angles["instances"])
expect(angles["image"]["instances"]["drawn"] == 4, angles["image"])
expect(angles["image"]["instances"]["points"] == 4 * angles["primitives"]["points"], angles)
shown = row["image"]["instances"]
expect((shown["drawn"], shown["hidden"], shown["outside"]) == (1, 1, 2), shown)
red, green, blue, _ = Png("row.png").rows[80][80]
expect(red > 100 and green < 60 and blue < 60, red, green, blue)
expect(all(f["instances"]["drawn"] == 4 for f in turn["frames"]), turn["frames"])
expect(report("zeros.json")["image"]["instances"]["drawn"] > 1, "twelve instances at 0 0 0")
box, merged = report("only.json")["bounds_world"], open("merged.ply", "rb").read()
points = list(struct.iter_unpack("<7f", merged[merged.index(b"end_header\n") + 11:]))
for axis in range(3):
    least, most = min(p[axis] for p in points), max(p[axis] for p in points)
    width = most - least
    expect(least - 0.2 * width < box[2 * axis] < least + 0.01 < most - 0.01 < box[2 * axis + 1] < most + 0.2 * width, box, least, most)
expect("instances   4, with rotations" in open("info.txt").read(), open("info.txt").read())
P

# refusals
printf 'x,y,z,scale\n0,0,0,1\n0,0,0,0\n' >in/flat.csv
printf 'x,y,z,scale\n0,0,0,nan\n' >in/nan.csv
printf 'x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0\n' >in/none.csv
printf 'x,y,z,qx,qy,qz\n0,0,0,0,0,0\n' >in/three.csv
printf 'x,y,z,qx,qy,qz,qw,rz\n0,0,0,0,0,0,1,9\n' >in/twice.csv
printf 'x,y,z,rx\n0,0,0,inf\n' >in/inf.csv
printf 'x,y,z\n' >in/empty.csv
printf 'x,y\n0,0\n' >in/plane.csv
printf 'x,y,z\n900,0,0\n' >in/away.csv
refused() { isorender_refuses "$1" "$2" in/ball.mha --isovalue 500 "${@:3}"; }
refused 3 'flat.csv: instance 2: its scale' --instances in/flat.csv
refused 3 'nan.csv: instance 1: its scale' --instances in/nan.csv
refused 3 'none.csv: instance 1: its quaternion is 0' --instances in/none.csv
refused 3 'three.csv: its quaternions (qx qy qz qw) have no qw' --instances in/three.csv
refused 3 'twice.csv: its rotations are given twice' --instances in/twice.csv
refused 3 'inf.csv: instance 1: its angles' --instances in/inf.csv
refused 6 'empty.csv: holds no instance' --instances in/empty.csv
refused 3 'plane.csv: its points have no z' --instances in/plane.csv
refused 3 'absent.csv' --instances in/absent.csv
refused 3 'ball.mha: not a file of' --instances in/ball.mha
refused 6 'nothing of the surface is in view' --instances in/away.csv --camera-position 9.5,-60,9.5 --camera-focal-point 9.5,0,9.5
refused 2 'mesh cannot draw --instances: that needs discs or splats (flat, onepass, ewa or mean)' --instances in/one.csv --method mesh
refused 2 'exact cannot draw --instances' --instances in/one.csv --method exact
refused 2 'an opacity below 1' --instances in/one.csv --opacity 0.5
refused 2 '--ior' --instances in/one.csv --ior 1.5
refused 2 '--instances cannot be drawn in chunks' --instances in/one.csv --chunk-size 16
isorender_refuses 2 'a picture without an input' --volume in/ball.mha --instances in/one.csv
cp in/one.csv kept.csv
refused 2 'in/one.csv' --instances in/one.csv --json=in/one.csv
cmp kept.csv in/one.csv

# by OpenGL: with radii of their own or one for all, colours, levels of detail, and instances beside the picture
isorender --list-backends | grep '^egl surfaceless.*, ' >/dev/null || exit 0
near="$look --resolution 160x160 --instances in/row.csv --camera front --camera-position 9.5,-60,9.5 --camera-focal-point 9.5,0,9.5"
for model in "in/ball.mha --isovalue 500 --method discs" "model.ply --method splats --lod 1"; do
    isorender $model $near cpu.png --json=cpu.json
    isorender $model $near gl.png --backend egl --json=gl.json
    isorender $model $near all.png --backend egl --selection all --json=all.json
    isocompare images cpu.png gl.png --fail-under psnr=43 >/dev/null
    same gl.png all.png
    python3 - <<'P'
from check import *
cpu, gl, every = (report(name + ".json") for name in ("cpu", "gl", "all"))
expect(gl["backend"] == "egl" and gl["image"]["instances"] == cpu["image"]["instances"], gl["image"], cpu["image"])
expect(gl["image"]["instances"]["hidden"] == 1 and every["image"]["instances"]["hidden"] == 0, gl["image"], every["image"])
P
done
