python3 -c 'from check import *; ball("in/<ball> & co.mha", header="ElementSpacing = 0.5 0.5 2\n")'
isocompare report 'in/<ball> & co.mha' --output report --side 64 --quiet
grep -q '<h1>&lt;ball&gt; &amp; co</h1>' report/report.html
python3 - <<'P'
from check import *
j = report("report/report.json")
expect(j["volume"]["spacing"] == [0.5, 0.5, 2] and j["isovalue_from"].startswith("Otsu"), j)
mesh = [row for row in j["rows"] if row["method"] == "mesh" and row["samples"] == 1]
expect(all(row["depth_error_voxel"] < 0.3 and row["iou"] > 0.9 for row in mesh), mesh)
P
