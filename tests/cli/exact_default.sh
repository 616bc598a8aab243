# the default, framed as raycast frames it, shows what raycast shows; and where points and meshes say that the surface is
python3 -c 'from check import *; ball("in/ball.mha", header="ElementSpacing = 0.5 0.5 2\nOffset = 10 20 30\n")'
isorender in/ball.mha exact.png --isovalue 500 --samples 1 --json=exact.json --resolution 120x90 --quiet
for method in raycast points mesh; do
    isorender in/ball.mha $method.png --method $method --isovalue 500 --json=$method.json --resolution 120x90 --quiet
done
isorender in/ball.mha both.png --isovalue 500 --samples 1 --points p.ply --json=both.json --resolution 120x90 --quiet
isorender scene:gyroid:48 gyroid.png --isovalue=-0.4,0.4 --camera iso --orthographic --samples 4 --json=gyroid.json \
    --resolution 80x80 --quiet
python3 - <<'P'
from check import *
j = {name: report(name + ".json") for name in ("exact", "raycast", "points", "mesh", "both", "gyroid")}
e = j["exact"]
expect(e["method"] == "exact" and j["both"]["method"] == "exact" and j["raycast"]["method"] == "raycast", e["method"])
expect(list(e["primitives"]) == ["cells"] and e["primitives"]["cells"] > 1000, e["primitives"])
expect(j["both"]["primitives"]["points"] == j["points"]["primitives"]["points"], j["both"]["primitives"])
expect(j["both"]["primitives"]["cells"] == e["primitives"]["cells"], j["both"]["primitives"])
for box in ("bounds_local", "bounds_world"):
    for other in ("points", "mesh", "raycast"):
        expect(all(abs(a - b) < 2e-3 for a, b in zip(e[box], j[other][box])), box, other, e[box], j[other][box])
    expect(e[box] == j["raycast"][box] == j["both"][box], box)
expect(e["camera"] == j["raycast"]["camera"], e["camera"])
expect(e["image"]["hash"] == j["both"]["image"]["hash"], "a file of points changes the picture")
expect(abs(e["image"]["covered"] - j["raycast"]["image"]["covered"]) <= 1, e["image"], j["raycast"]["image"])
off = [max(abs(a - b) for a, b in zip(p, q)) for p, q in zip(Png("exact.png").pixels(), Png("raycast.png").pixels())]
expect(sum(d > 1 for d in off) <= 2, sum(d > 1 for d in off))
expect(j["gyroid"]["image"]["covered"] > 4000, j["gyroid"]["image"])
P
