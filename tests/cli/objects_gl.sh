# lines, glyphs and meshes by OpenGL: the pictures, counts and ids of the cpu; beside every method that OpenGL has
python3 - <<'P'
from check import *
ball("in/ball.mha")
open("in/axis.swc", "w").write("# a line along x with growing radius\n1 1 -40 0 0 1 -1\n2 1 0 0 0 2 1\n3 1 40 0 0 4 2\n")
open("in/two.obj", "w").write("v 0 0 -30\nv 0 0 30\nv 0 -30 0\nv 0 30 0\nl 1 2\nl 3 4\n")
open("in/dots.csv", "w").write("x,y,z,radius,heat\n0,0,30,3,1\n0,0,-30,3,2\n30,0,0,6,5\n")
P
isorender in/ball.mha alone.png --isovalue 500 --mesh ball.stl --quiet
tried=0
for backend in egl osmesa; do
    isorender --list-backends | grep "^$backend" | grep -qv 'cannot be used' || { echo "no $backend here"; continue; }
    draw() { # NAME OPTIONS: the picture by both engines
        local name=$1
        shift
        isorender "$@" cpu_$name.png --backend cpu --json=cpu_$name.json --aov cpu_$name.exr --resolution 240x200 --quiet
        isorender "$@" gl_$name.png --backend $backend --json=gl_$name.json --aov gl_$name.exr --resolution 240x200 --quiet
        isocompare images cpu_$name.png gl_$name.png --fail-under psnr=45 >/dev/null
    }
    objects="--lines in/axis.swc --lines in/two.obj --line-style tube --line-style line --line-color red
        --line-color direction --glyphs in/dots.csv"
    draw ribbons --camera front --orthographic --lines in/axis.swc --lines in/two.obj --line-style ribbon
    draw alone $objects --surface ball.stl
    isorender in/ball.mha gl_skull.png --isovalue 500 --method mesh $objects --surface ball.stl --backend $backend --quiet
    isorender in/ball.mha cpu_skull.png --isovalue 500 --method mesh $objects --surface ball.stl --quiet
    isocompare images cpu_skull.png gl_skull.png --fail-under psnr=40 >/dev/null # triangles, without ids
    isorender --surface ball.stl gl_skull.png --resolution 200x200 --backend $backend --quiet
    isorender --surface ball.stl cpu_skull.png --resolution 200x200 --quiet
    isocompare images cpu_skull.png gl_skull.png --fail-under psnr=40 >/dev/null
    draw dots --glyphs in/dots.csv --glyph ellipsoid --color-by heat --samples 4
    draw mesh in/ball.mha --isovalue 500 --method mesh $objects
    draw splats in/ball.mha --isovalue 500 --method splats $objects
    draw discs in/ball.mha --isovalue 500 --method discs $objects
    draw pullpush in/ball.mha --isovalue 500 --method pullpush $objects
    BACKEND=$backend python3 - <<'P'
import os
from check import *
for name in ("ribbons", "alone", "dots", "mesh", "splats", "discs", "pullpush"):
    cpu, gl = report("cpu_%s.json" % name), report("gl_%s.json" % name)
    expect(gl["backend"] == os.environ["BACKEND"] and gl["gl"]["messages"] == 0, gl)
    expect(gl["gl"]["seconds"]["draw"] > 0, gl["gl"])
    for a, b in zip(cpu["objects"], gl["objects"]):
        near = abs(a.get("samples", 0) - b.get("samples", 0))
        expect(a["path"] == b["path"] and near <= 10 + .02 * a.get("samples", 0), (name, a, b))
P
    tried=$((tried + 1))
done
code=0
isorender in/ball.mha none.png --isovalue 500 --opacity 0.5 --lines in/axis.swc --backend osmesa 2>said || code=$?
[ $code -eq 2 ]
grep -q "draws translucent surfaces by --method splats (groups or flat)" said
[ $tried -gt 0 ] || exit 77
