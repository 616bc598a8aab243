[ -f "${ISO_TEST_VOLUMES:-}/INDEX.tsv" ] || { echo "skipped: no real volumes in '${ISO_TEST_VOLUMES:-}'"; exit 77; }
python3 - <<'P'
import csv
import os
import subprocess
from check import *

folder = os.environ["ISO_TEST_VOLUMES"]
extra = {"hydrogenatom.raw": ["--raw", "128x128x128:uint8"], "brainsmall.den": ["--raw", "128x128x84:uint8::62"]}
with open(folder + "/INDEX.tsv", encoding="utf-8") as file:
    rows = list(csv.DictReader(file, delimiter="\t"))
expect(len(rows) >= 15, len(rows))
bad = []
for row in rows:
    name = os.path.basename(row["path"])
    command = ["isorender", folder + "/" + row["path"], "--isovalue", row["isovalue"], "--method", "mesh", "--points",
               "p.ply", "--no-image", "--json", "--mesh", "m.stl", "--quiet"] + extra.get(name, [])
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 3 and ("built without" in done.stderr or "is not installed" in done.stderr):
        print("left out:", done.stderr.strip())
        continue
    if done.returncode != 0:
        bad.append((name, done.stderr))
        continue
    j = json.loads(done.stdout)
    p = j["primitives"]
    if p["triangles"] != int(row["ref_triangles_at_iso"]):
        bad.append((name, "triangles", p["triangles"], row["ref_triangles_at_iso"]))
    if p["kind"] == "edge" and p["points"] != p["vertices"]:
        bad.append((name, "points", p["points"], "vertices", p["vertices"]))
    # foot points lie on the same surface, but not at its extremes
    half = 0.5 * max(float(s) for s in row["spacing"].split()) + 0.005
    reference = [float(v) for v in row["ref_bounds_mm"].split()]
    if any(abs(a - b) > half for a, b in zip(j["bounds_local"], reference)):
        bad.append((name, "bounds", j["bounds_local"], reference))
expect(not bad, *bad)
P
