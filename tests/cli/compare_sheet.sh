# pairs by name: the numbers of isocompare surfaces, a table and distance maps; what has no partner or is broken is a red panel; only
# pairs that changed are compared again; the same bytes for any number of processes
python3 - <<'P'
from check import *
import math, os
def solid(r): return lambda x, y, z: 10 * (r - math.dist((x, y, z), (11.2, 11.7, 10.9)))
for folder in ("in/a", "in/b"):
    os.mkdir(folder)
for name, one, other in (("p1.mha", 6, 7), ("p2 <b>.mha", 7, 5)):
    volume("in/a/" + name, (24, 24, 24), solid(one))
    volume("in/b/" + name, (24, 24, 24), solid(other))
volume("in/a/alone.mha", (24, 24, 24), solid(5))
volume("in/b/new.mha", (24, 24, 24), solid(5))
for folder in ("in/a", "in/b"):
    open(folder + "/broken.nrrd", "w").write("NRRD0004\n")
    open(folder + "/notes.json", "w").write("{}")
P
isocompare sheet in/a in/b/ --isovalue 0 -o out.html --side 128 --jobs 1 --json=one.jsonl 2>said && exit 1 || [ $? -eq 3 ]
grep -q 'wrote out.html: 5 panels, 2 drawn, 0 kept, 3 failed' said
mkdir four
isocompare sheet in/a in/b/ --isovalue 0 -o four/out.html --side 128 --jobs 4 --quiet 2>/dev/null || [ $? -eq 3 ]
cmp out.html four/out.html
isocompare surfaces in/a/p1.mha in/b/p1.mha --isovalue 0 --json=p1.json --quiet
python3 - <<'P'
import json
from check import *
lines = {j["input"]: j for j in map(json.loads, open("one.jsonl"))}
p1, direct = lines["in/a/p1.mha"], report("p1.json")
expect(p1["beside"] == "in/b/p1.mha" and p1["status"] == 0, p1)
for sheet, surfaces in (("mean", "mean_of_both"), ("hausdorff", "hausdorff_of_both"), ("dice", "dice")):
    expect(p1[sheet] == direct[surfaces], sheet, p1, direct)
expect(p1["volume_a"] == direct["a"]["volume"] and p1["difference"] == direct["b"]["volume"] - direct["a"]["volume"], p1)
expect(lines["in/a/new.mha"]["status"] == 3 and "in/b/alone.mha" in lines["in/a/alone.mha"]["error"], lines)
page = open("out.html").read()
expect("<b>.mha" not in page and "p2 &lt;b&gt;.mha" in page and page.count("<tr>") == 6 and page.count("class=bad") == 3)
P
python3 - <<'P'
from check import *
import math
volume("in/b/p1.mha", (24, 24, 24), lambda x, y, z: 10 * (8 - math.dist((x, y, z), (11.2, 11.7, 10.9))))
P
isocompare sheet in/a in/b/ --isovalue 0 -o out.html --side 128 2>said || [ $? -eq 3 ]
grep -q '5 panels, 1 drawn, 1 kept, 3 failed' said
isocompare sheet in/a in/b/ --isovalue 0 -o out.png --side 128 --quiet 2>/dev/null || [ $? -eq 3 ]
refuses 2 "two folders" isocompare sheet in/a -o bad.html || exit 1
refuses 2 "needs a name" isocompare sheet in/a in/b || exit 1
refuses 3 "cannot read this folder" isocompare sheet in/a in/c -o bad.html || exit 1
refuses 2 "jobs does not belong to surfaces" isocompare surfaces in/a/p1.mha in/b/p1.mha --jobs 2 || exit 1
refuses 2 "fail-under does not belong to sheet" isocompare sheet in/a in/b -o bad.html --fail-under psnr=3 || exit 1
