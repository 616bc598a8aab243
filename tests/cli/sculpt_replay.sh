# the same bytes for any number of threads, with and without extraction and pictures on the way; JSON; another voxel size
bear=$volumes/bear.strokes
isosculpt --replay $bear --headless --output a.ply --mesh a.stl --threads 1 --json=a.json
isosculpt --replay $bear --headless --output b.ply --mesh b.stl --threads 3 --extract --draw --resolution 320x200 \
    --json=b.json
cmp a.ply b.ply
cmp a.stl b.stl
isosculpt --replay $bear --headless --voxel-size 1 --output c.obj --json > c.json
python3 - <<'P'
from check import *
a, b, c = report("a.json"), report("b.json"), report("c.json")
expect(a["strokes"] == b["strokes"] == c["strokes"] == 31 and a["undone"] == 1, a)
expect(a["samples"] == a["seconds"]["edit"]["count"] == b["seconds"]["extract"]["count"], a, b)
expect(b["seconds"]["draw"]["count"] == b["seconds"]["step"]["count"] == b["samples"], b)
expect(b["resolution"] == [320, 200] and "draw" not in a["seconds"], a, b)
expect(a["points"] == b["points"] and a["points"] > 100000 and a["bricks"] == b["bricks"], a, b)
expect(3.5 < a["points"] / c["points"] < 4.5, "a quarter of the points at twice the size", a["points"], c["points"])
expect(c["schema"] == "isosculpt/1" and c["dims"] == [128, 128, 128] and c["voxel_size"] == 1, c)
P
isorender a.ply --no-image --json=points.json --quiet
python3 -c 'from check import *; expect(report("points.json")["primitives"]["points"] == report("a.json")["points"])'
# a stroke file that breaks off ends there; its incomplete last line is dropped
head -c 30000 $bear > short.strokes
isosculpt --replay short.strokes --headless --json=short.json
python3 -c 'from check import *; expect(0 < report("short.json")["strokes"] < 31)'
