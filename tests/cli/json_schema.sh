python3 -c 'from check import *; ball("in/ball.mha", header="ElementSpacing = 0.5 0.5 2\nOffset = 10 20 30\n")'
isorender in/ball.mha out.png --isovalue 500 --method mesh --points p.ply --json --quiet >j.json
python3 - <<'P'
from check import *
j = report("j.json")
expect(j["schema"] == "isorender/1" and j["backend"] == "cpu" and j["renderer"] and j["version"], j)
v = j["volume"]
expect(v["dims"] == [24, 24, 24] and v["type"] == "float32" and v["path"] == "in/ball.mha", v)
expect(v["spacing"] == [0.5, 0.5, 2] and v["origin"] == [10, 20, 30] and len(v["direction"]) == 9, v)
expect(j["isovalue"] == 500 and j["isovalues"] == [500], j["isovalues"])
p = j["primitives"]
expect(p["points"] == p["vertices"] and p["triangles"] == 2 * p["vertices"] - 4, p)  # Euler: a sphere
near = lambda a, b: all(abs(x - y) < 0.1 for x, y in zip(a, b))
expect(near(j["bounds_local"], [1.75, 9.75, 1.75, 9.75, 7, 39]), j["bounds_local"])
expect(near(j["bounds_world"], [11.75, 19.75, 21.75, 29.75, 37, 69]), j["bounds_world"])
expect(set(j["seconds"]) == {"load", "extract", "render", "write", "total"}, j["seconds"])
parts = sum(j["seconds"][k] for k in ("load", "extract", "render", "write"))
expect(0 < parts <= j["seconds"]["total"] * 1.001, j["seconds"])
expect(j["peak_bytes"] > 1 << 20 and j["nonfinite"] == 0 and j["threads"] >= 1, j)
c = j["camera"]
expect(near(c["focal_point"], [15.75, 25.75, 53]) and c["position"][1] < 20 and c["view_up"] == [0, 0, 1], c)
i = j["image"]
expect(i["path"] == "out.png" and i["width"] == i["height"] == 1024 and i["samples"] == 1, i)
expect(i["covered"] > 10000 and len(i["hash"]) == 16, i)
P
