python3 -c 'from check import *; ball("in/ball.mha", header="ElementSpacing = 0.5 0.5 2\nOffset = 10 20 30\n")'
isorender in/ball.mha a.png --isovalue 500 --method points --points p.ply --json=a.json --quiet
isorender p.ply b.png --method points --json=b.json --quiet
head -c 400 p.ply | tr -d '\0' | grep -a -q '^property float radius'
python3 - <<'P'
from check import *
a, b = report("a.json"), report("b.json")
expect(a["primitives"]["points"] == b["primitives"]["points"], a["primitives"], b["primitives"])
expect(all(abs(x - y) < 1e-4 for x, y in zip(a["bounds_world"], b["bounds_world"])), b["bounds_world"])
expect(abs(a["image"]["covered"] - b["image"]["covered"]) < 0.002 * a["image"]["covered"], a["image"], b["image"])
expect(b["isovalue"] is None and b["volume"]["format"] == "ply", b["volume"])
P
