python3 -c 'from check import *; ball("in/<ball> & co.mha", header="ElementSpacing = 0.5 0.5 2\n")'
isocompare report 'in/<ball> & co.mha' --output report --side 64 --quiet
grep -q '<h1>&lt;ball&gt; &amp; co</h1>' report/report.html
python3 - <<'P'
from check import *
j = report("report/report.json")
expect(j["volume"]["spacing"] == [0.5, 0.5, 2] and j["isovalue_from"].startswith("Otsu"), j)
mesh = [row for row in j["rows"] if row["method"] == "mesh" and row["samples"] == 1]
expect(all(row["depth_error_voxel"] < 0.3 and row["iou"] > 0.9 for row in mesh), mesh)
t = j["transparency"]
expect(t["side"] == 64 and t["truth"] == "raycast" and 500 < t["covered"] < 64 * 64, t)
expect(1.9 < t["mean_layers"] <= 2 and t["most_layers"] == 2, "a ball has two layers", t)
rows = {(row["compositing"], row["opacity"]): row for row in t["rows"]}
names = ("exact", "average", "weighted", "splats", "splats-groups", "splats-nearest")
expect(set(rows) == {(name, opacity) for name in names for opacity in (0.3, 0.5, 0.7)}, list(rows))
for (name, opacity), row in rows.items():
    expect(row.get("wrong_layers") == (0 if name == "exact" else None), row)
    expect(float(row["psnr"]) > (80 if name == "exact" else 10), row)
    expect(name == "exact" or float(row["psnr"]) < float(rows["exact", opacity]["psnr"]), row)
P
