# --measure: volume, area, size, thickness and distances of a ball, a box and a ring as geometry says; also of strokes; in words and
# as JSON; nonsense is refused in one line
cat > make.py <<'P'
import strokes as s
write = lambda name, events: s.write(name + ".strokes", events, s.header(voxel_size=0.5, dims=[128, 128, 128], origin=[-31.75] * 3, radius=23.0))
write("ball", [])
write("hole", [s.begin({"at": [0.0, 0.0, 0.0]}, tool="carve", radius=15.0), {"event": "end"}])
write("gone", [s.begin({"at": [0.0, 0.0, 0.0]}, tool="carve", radius=30.0), {"event": "end"}])
P
python3 make.py
measure() { isosculpt --headless --quiet --measure="$2" --json="$1.json" "${@:3}"; }
measure box 0/0/10.3,3/-15.2/1,20/0/0 --new box:40x30x20
measure ring 25/0/0,-25/0/0,11/0/0 --new torus:50x14 --voxel-size 0.25
measure hole 0/23.2/0,0/15/0 --replay hole.strokes
measure one 0/23.2/0,0/15/0 --replay hole.strokes --threads 1
isosculpt --headless --replay ball.strokes --measure 2>words
grep -q "volume 50[89].* mm3, area 66[34].* mm2, size 4[56].* x 4[56].* x 4[56].* mm, 1 piece" words && [ "$(wc -l <words)" = 1 ] || { cat words; exit 1; }
isosculpt --headless --replay ball.strokes --measure=0/0/24,0/24/0 2>words
grep -q "place 2: 0/2[23].*/0, thickness 4[56].* mm, 32.5.* mm from place 1" words || { cat words; exit 1; }
for bad in 1/2 1/2/3, 1,2,3 1/2/x 1/2/nan 1/2/3/4; do
    code=0
    isosculpt --headless --replay ball.strokes "--measure=$bad" 2>message || code=$?
    [ "$code" = 2 ] && [ "$(wc -l <message)" = 1 ] && grep -q "X/Y/Z" message || { echo "$bad: $code"; cat message; exit 1; }
done
code=0
isosculpt --headless --replay gone.strokes --measure 2>message || code=$?
[ "$code" = 6 ] && [ "$(wc -l <message)" = 1 ] || { cat message; exit 1; }
code=0
isosculpt ball.strokes --measure 2>message || code=$?
[ "$code" = 2 ] && grep -q "needs --headless" message
python3 - <<'P'
from check import *
from math import pi
m = lambda name: report(name + ".json")["measured"]
near = lambda value, wanted, part: abs(value / wanted - 1) < part
box, ring, hole = m("box"), m("ring"), m("hole")
expect(hole == m("one"), "threads")
expect(near(box["volume"], 24000, 0.002) and near(box["area"], 5200, 0.012) and box["pieces"] == 1, box)
expect(all(near(h - l, w, 0.002) for h, l, w in zip(box["high"], box["low"], (40, 30, 20))), box)
expect([round(p["thickness"], 2) for p in box["places"]] == [20, 30, 40], box)
expect(near(box["places"][1]["distance"], (9 + 225 + 81) ** 0.5, 0.001), box)
expect(near(ring["volume"], 2 * pi * pi * 18 * 49, 0.002) and all(near(p["thickness"], 14, 0.002) for p in ring["places"]), ring)
expect(near(ring["places"][1]["distance"], 50, 0.001), ring)
shell = 4 / 3 * pi * (23**3 - 15**3)
expect(near(hole["volume"], shell, 0.004) and hole["pieces"] == 2 and all(near(p["thickness"], 8, 0.01) for p in hole["places"]), hole)
expect(near(hole["places"][1]["distance"], 8, 0.01), hole)
P
