for side in front back left right top bottom iso; do
    isorender scene:torus:32 --camera $side --resolution 20x20 --quiet -o $side.png --json=$side.json
done
isorender scene:torus:32 y.png --up +y --camera front --resolution 20x20 --quiet --json=y.json
isorender scene:torus:32 turned.png --azimuth 90 --resolution 20x20 --quiet --json=turned.json
isorender scene:torus:32 placed.png --camera-position 100,-200,300 --camera-view-angle 50 --zoom 2 --quiet --json=placed.json
isorender scene:torus:32 flat.png --orthographic --resolution 20x20 --quiet --json=flat.json
python3 - <<'P'
from check import *
def forward(name):
    c = report(name + ".json")["camera"]
    v = [f - p for f, p in zip(c["focal_point"], c["position"])]
    length = sum(x * x for x in v) ** 0.5
    return [x / length for x in v]
s = 3 ** -0.5
for name, want in {"front": (0, 1, 0), "back": (0, -1, 0), "left": (-1, 0, 0), "right": (1, 0, 0), "top": (0, 0, -1),
                   "bottom": (0, 0, 1), "iso": (-s, s, -s), "turned": (-1, 0, 0)}.items():
    expect(all(abs(a - b) < 1e-9 for a, b in zip(forward(name), want)), name, forward(name))
y = report("y.json")["camera"]
expect(all(abs(a - b) < 1e-9 for a, b in zip(y["view_up"], (0, 1, 0))), y)
c = report("placed.json")["camera"]
expect(c["position"] == [100, -200, 300] and 20 < c["view_angle"] < 30, c)
expect(report("flat.json")["camera"]["parallel_scale"] > 0, "flat")
P
