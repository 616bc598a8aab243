command -v povray >/dev/null || { echo "skipped: there is no povray"; exit 77; }
# the outlines of glyphs and of tubes are those that POV-Ray traces, in perspective and in parallel views
python3 - <<'P'
import math
import random
import subprocess
from check import *

SIZE, ANGLE, PIXEL = 256, 30.0, 0.1
EYE, UP = (30.0, -62.0, 25.0), (0.0, 0.0, 1.0)
random.seed(7)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scale(a, s):
    return tuple(x * s for x in a)


def unit(a):
    return scale(a, 1 / math.hypot(*a))


def point(limit=11.0):
    return tuple(round(random.uniform(-limit, limit), 4) for _ in range(3))


def pov(*vectors):
    return ", ".join("<%.9g, %.9g, %.9g>" % v for v in vectors)


def camera(parallel):
    forward = unit(scale(EYE, -1))
    right = unit(cross(forward, UP))
    up = cross(right, forward)
    side = SIZE * PIXEL if parallel else 1
    length = 1 if parallel else 0.5 / math.tan(math.radians(ANGLE / 2))
    return "camera { %s location %s right %s up %s direction %s }\n" % (
        "orthographic" if parallel else "perspective", pov(EYE), pov(scale(right, side)), pov(scale(up, side)),
        pov(scale(forward, length)))


def spheres():
    rows = [(point(), round(random.uniform(0.2, 2), 4)) for _ in range(60)]
    text = "x,y,z,radius\n" + "".join("%g,%g,%g,%g\n" % (*p, r) for p, r in rows)
    return text, "".join("sphere { %s, %g }\n" % (pov(p), r) for p, r in rows)


def directed(shape):
    rows = [(point(), point(3), round(random.uniform(0.2, 1.2), 4)) for _ in range(60)]
    text = "x,y,z,vx,vy,vz,radius\n" + "".join("%g,%g,%g,%g,%g,%g,%g\n" % (*p, *v, r) for p, v, r in rows)
    solids = ""
    for p, v, r in rows:
        end = tuple(a + b for a, b in zip(p, v))
        solids += {"cone": "cone { %s, %g, %s, 0 }\n" % (pov(p), r, pov(end)),
                   "cylinder": "cylinder { %s, %g }\n" % (pov(p, end), r),
                   "disc": "disc { %s, %g }\n" % (pov(p, v), r)}[shape]
    return text, solids


def tubes():
    text, solids, number = "", "", 1
    for _ in range(12):
        at = point(6)
        solids += "sphere_sweep { linear_spline, 6"
        for i in range(6):
            r = round(random.uniform(0.15, 1.2), 4)
            text += "%d 1 %g %g %g %g %d\n" % (number, *at, r, number - 1 if i else -1)
            solids += ", %s, %g" % (pov(at), r)
            at = tuple(round(a + b, 4) for a, b in zip(at, point(3)))
            number += 1
        solids += " tolerance 1e-9 }\n"
    return text, solids


def outline(name, file, options, solids, parallel):
    view = ["--mm-per-pixel", str(PIXEL)] if parallel else []
    subprocess.run(["isorender", *file, name + ".png", "--samples", "1", "--camera-position", "%g,%g,%g" % EYE, "--camera-focal-point", "0,0,0",
                    "--camera-view-up", "%g,%g,%g" % UP, "--view-angle", str(ANGLE), "--resolution", "%dx%d" % (SIZE, SIZE),
                    "--background", "none", "--quiet", *options, *view], check=True)
    with open("in/%s.pov" % name, "w") as scene:
        scene.write("#version 3.7;\nglobal_settings { assumed_gamma 1 }\nbackground { rgb 0 }\n" + camera(parallel) +
                    "union {\n" + solids + "pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }\n")
    subprocess.run(["povray", "+Iin/%s.pov" % name, "+Oin/%s.png" % name, "+W%d" % SIZE, "+H%d" % SIZE, "-D", "-A", "+FN8", "-GA"],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    ours, theirs = Png(name + ".png").pixels(), Png("in/%s.png" % name).pixels()
    covered = [p[3] > 0 for p in ours]
    wrong = sum(a != (p[0] > 0) for a, p in zip(covered, theirs))
    print(name, "parallel" if parallel else "perspective", sum(covered), "pixels,", wrong, "differ")
    expect(sum(covered) > 2000, name, "covers only", sum(covered))
    expect(wrong <= 2, name, wrong, "pixels differ from POV-Ray's")


def compare(name, ending, made, options):
    text, solids = made
    path = "in/%s.%s" % (name, ending)
    with open(path, "w") as file:
        file.write(text)
    option = "--lines" if ending == "swc" else "--glyphs"
    for parallel in (False, True):
        outline(name, [option, path], options, solids, parallel)


compare("spheres", "csv", spheres(), [])
for shape in ("cone", "cylinder", "disc"):
    compare(shape + "s", "csv", directed(shape), ["--glyph", shape])
compare("tubes", "swc", tubes(), ["--line-min-pixels", "0"])
P
