isosculpt --replay $volumes/bear.strokes --headless --output bear.vdb --json=a.json 2>error.txt || { grep -q "not installed" error.txt && { echo "skipped: without OpenVDB"; exit 77; }; cat error.txt; exit 1; }
isorender bear.vdb bear.png --method points --resolution 200x200 --json=b.json --quiet
python3 - <<'P'
from check import *
a, b = report("a.json"), report("b.json")
expect(b["volume"]["level_set"] and b["volume"]["sparse"], b["volume"])
expect(a["points"] == b["primitives"]["points"], a["points"], b["primitives"])
expect(abs(b["volume"]["spacing"][0] - 0.5) < 1e-9, b["volume"])
lo, hi = b["bounds_world"][0::2], b["bounds_world"][1::2]
expect(lo[2] < -30 and hi[2] > 45 and abs(lo[0] + hi[0]) < 0.2, b["bounds_world"])
P
