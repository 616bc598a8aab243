# --json says which engine has drawn the picture and its objects, and a note says why where OpenGL was asked for by name
isorender --list-backends | grep '^egl surfaceless.*, ' >/dev/null || { echo "no egl here"; exit 77; }
python3 - <<'P'
from check import *
volume("in/ball.mha", (48, 48, 48), lambda x, y, z: 900.0 - 2 * ((x - 24) ** 2 + (y - 24) ** 2 + (z - 24) ** 2))
open("in/axis.swc", "w").write("1 1 0 24 24 2 -1\n2 1 24 24 60 2 1\n3 1 48 24 24 4 2\n")
open("in/plate.stl", "w").write("solid p\nfacet normal 0 0 1\nouter loop\nvertex 0 0 60\nvertex 48 0 60\nvertex 0 48 60\n"
                                "endloop\nendfacet\nendsolid p\n")
P
draw() { # NAME OPTION..
    local name=$1
    shift
    isorender "$@" $name.png --backend egl --resolution 90x70 --json=$name.json 2>$name.said
}
points="in/ball.mha --isovalue 500"
draw lines --lines in/axis.swc --method pullpush
draw exact_lines --lines in/axis.swc
draw beside $points --method pullpush --lines in/axis.swc
draw discs $points --method discs --lines in/axis.swc
draw ids $points --method mesh --surface in/plate.stl --aov ids.exr
draw layers $points --method splats --opacity 0.5 --lines in/axis.swc
draw chunks $points --method pullpush --chunk-size 16
draw hybrid $points --method hybrid --lines in/axis.swc
draw quiet $points --method pullpush --lines in/axis.swc --quiet
isorender $points auto.png --method hybrid --resolution 90x70 --lines in/axis.swc --json=auto.json 2>auto.said
python3 - <<'P'
from check import *
def told(name):
    r = report(name + ".json")
    return r["backend"], [o.get("backend") for o in r.get("objects", [])], [
        line.split("note: --backend egl: ")[1] for line in open(name + ".said").read().splitlines() if "--backend egl" in line]
for name, backend, objects, notes in (
        ("lines", "egl", [None], []), ("exact_lines", "egl", [None], []), ("beside", "egl", [None], []),
        ("discs", "egl", [None], []), ("quiet", "egl", [None], []), ("hybrid", "egl", [None], []), ("auto", "cpu", [None], []),
        ("ids", "egl", ["cpu"], ["the cpu draws in/plate.stl: OpenGL does not number triangles, as --aov does"]),
        ("layers", "egl", ["cpu"], ["the cpu draws in/axis.swc: OpenGL draws nothing beside translucent splats"]),
        ("chunks", "cpu", [], ["the cpu draws chunks"])):
    expect(told(name) == (backend, objects, notes), name, told(name))
    expect(("gl" in report(name + ".json")) == (backend == "egl"), name)
expect(report("layers.json")["gl"]["seconds"].get("draw", 0) > 0, "layers are not timed")
P
for what in "--ior 1.5" "--method pullpush --clip x"; do
    isorender_refuses 2 "the cpu" $points --backend egl $what
done
