isosculpt --replay $volumes/bear.strokes --headless --voxel-size 1 --output bear.vdb --mesh bear.stl --json=a.json 2>error.txt || { grep -q "not installed" error.txt && { echo "skipped: without OpenVDB"; exit 77; }; cat error.txt; exit 1; }
isosculpt --open bear.vdb --headless --output again.vdb --mesh again.stl --json=b.json
isosculpt --open bear.vdb --headless --voxel-size 2 --output coarse.ply --json=c.json --quiet
isosculpt --open bear.stl --headless --voxel-size 1 --output mesh.obj --json=d.json
isosculpt --open bear.stl --headless --voxel-size 1 --replay $volumes/head.strokes --output both.ply --json=e.json --quiet
python3 - <<'P'
from check import *
a, b, c, d, e = (report(n + ".json") for n in "abcde")
expect(a["points"] == b["points"] and a["source"] == "ball", a, b)
expect(b["source"].endswith("/bear.vdb") and b["voxel_size"] == 1, b)
expect(c["voxel_size"] == 2 and 0.2 < c["points"] / a["points"] < 0.3, a["points"], c["points"])
expect(0.95 < d["points"] / a["points"] < 1.05 and d["dims"][0] % 16 == 0, a["points"], d)
expect(e["strokes"] > 10 and e["source"].endswith("/bear.stl"), e)
P
