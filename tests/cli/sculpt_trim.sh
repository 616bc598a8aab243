# trimming by a line and by a lasso: volumes as geometry says, the same bytes by any number of threads and at the end of edits,
# outlines that enclose nothing are refused in one line
cat > make.py <<'P'
import math

import strokes as s

def outline(points, eye=None, **brush):
    def at(point):
        x, y = point
        n = (0.0 - x, 0.0 - y, eye) if eye else (0.0, 0.0, 1.0)
        length = math.sqrt(sum(c * c for c in n))
        return {"at": [x, y, 0.0], "normal": [c / length for c in n]}
    return [s.begin(at(points[0]), **brush), *(s.sample(**at(p)) for p in points[1:]), {"event": "end"}]

circle = [(12 * math.cos(t / 20 * math.pi), 12 * math.sin(t / 20 * math.pi)) for t in range(40)]
head = s.header(voxel_size=0.5, dims=[128, 128, 128], origin=[-31.75] * 3, radius=23.0)
write = lambda name, events: s.write(name + ".strokes", events, head)
write("ball", [])
write("line", outline([(0.0, -9.0), (0.0, 9.0)], tool="trim-plane"))
write("back", outline([(0.0, 9.0), (0.0, -9.0)], tool="trim-plane"))
write("hole", outline(circle, tool="trim-lasso"))
write("core", outline(circle, tool="crop-lasso"))
write("cone", outline(circle, 60.0, tool="crop-lasso"))
write("gone", outline([(40.0, 40.0), (-40.0, 40.0), (-40.0, -40.0), (40.0, -40.0)], tool="trim-lasso"))
for name, points, tool in (("two", [(0.0, 0.0), (5.0, 0.0)], "trim-lasso"), ("flat", [(0.0, 0.0), (5.0, 0.0), (9.0, 0.0)], "crop-lasso"),
                           ("point", [(1.0, 0.0), (1.0, 0.0)], "trim-plane")):
    s.write(name + ".bad", outline([(0.0, -9.0), (0.0, 9.0)], tool="trim-plane") + outline(points, tool=tool), head)
write("killed", outline([(0.0, -9.0), (0.0, 9.0)], tool="trim-plane") + outline(circle, tool="trim-lasso")[:-1])
P
python3 make.py
play() { isosculpt --replay "$1.strokes" --headless --mesh "$2.ply" --json="$2.json" --quiet "${@:3}"; }
for name in ball line back hole core cone; do play $name $name; done
play hole one --threads 1
cmp hole.ply one.ply
play hole edited --edit 1:tool=crop-lasso --save-strokes edited.strokes
cmp edited.ply core.ply
play edited again
cmp again.ply core.ply
play hole round --edit 1:blend=2
play line muted --mute 1
cmp muted.ply ball.ply
# a session that was killed within a lasso: what the lasso would have removed is there
play killed killed --save-strokes kept.strokes
cmp killed.ply line.ply
play kept kept
cmp kept.ply line.ply
isorender killed.strokes killed.png --resolution 40x40 --quiet
python3 - <<'P'
from check import *
from math import pi, sqrt, tan, atan
volume = {name: report(name + ".json")["mesh"]["volume"] for name in ("ball", "line", "back", "hole", "core", "cone", "round")}
ball, r, a = 4 / 3 * pi * 23**3, 23.0, 12.0
near = lambda value, wanted: abs(value - wanted) < 0.004 * ball
expect(near(volume["line"], ball / 2) and near(volume["back"], ball / 2), volume)
left = 4 / 3 * pi * sqrt(r * r - a * a) ** 3  # of a ball with a round hole through it
expect(near(volume["hole"], left) and near(volume["core"], ball - left), volume)
# the cone from (0, 0, 60) through the circle, within the ball, by slices
cone = sum(pi * min(r * r - z * z, (a * (60 - z) / 60) ** 2) * 0.01 for z in (-r + 0.01 * (i + 0.5) for i in range(4600)))
expect(near(volume["cone"], cone), (volume, cone))
expect(0.98 < volume["round"] / volume["hole"] < 0.9995, volume)
P
# everything removed: said, and nothing is written
code=0
isosculpt --replay gone.strokes --headless --mesh gone.ply --quiet 2>message || code=$?
[ "$code" != 0 ] && grep -q "nothing is left of the solid" message && [ ! -e gone.ply ]
for bad in two flat point; do
    cp $bad.bad bad.strokes
    code=0
    isosculpt --replay bad.strokes --headless --mesh bad.ply --quiet 2>message || code=$?
    [ "$code" = 3 ] && [ "$(wc -l <message)" = 1 ] && grep -q "bad.strokes' line [0-9]*: " message && [ ! -e bad.ply ] ||
        { echo "$bad: $code"; cat message; exit 1; }
done
