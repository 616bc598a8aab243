# A contact sheet: each panel is the picture of isorender alone; files that are broken in ten ways, one of them with a hostile name,
# become red panels; the bytes do not depend on --jobs, nor on what was kept by runs before; only what changed is drawn again.
python3 - <<'P'
from check import *
import gzip, os, struct
for i, r in enumerate((8.0, 4.0, 6.0, 7.0)):
    ball("in/b%d.mha" % i, radius=r)
good = open("in/b0.mha", "rb").read()
def write(name, data):
    open("in/" + name, "wb").write(data)
write("x1-empty.mha", b"")
write("x2-text.nrrd", b"hello\n")
write("x3-cut.mha", good[:-1000])
write("x4-size.mha", good.replace(b"DimSize = 24", b"DimSize = 0"))
write("x5-gzip.nii.gz", gzip.compress(good)[:200])
write("x6-type.mha", good.replace(b"MET_FLOAT", b"MET_OTHER"))
volume("in/x7-constant.mha", (8, 8, 8), lambda x, y, z: 3.0)
volume("in/x8-nan.mha", (8, 8, 8), lambda x, y, z: float("nan"))
os.mkdir("in/x9-folder")
write("x10 <img src=x onerror=alert(1)>&\"'\n\x1b[31m.mha", b"\x89PNG")
P
isorender sheet in/b*.mha in/x*.* in/x9-folder in/missing.mha -o qc.html --measure volume --jobs 1 --json=1.jsonl 2>said && exit 1 || [ $? -eq 3 ]
[ "$(wc -l <said)" -eq 12 ]
grep -q 'wrote qc.html: 15 panels, 4 drawn, 0 kept, 11 failed' said
[ "$(ls qc-panels | wc -l)" -eq 4 ]
mkdir four
isorender sheet in/b*.mha in/x*.* in/x9-folder in/missing.mha -o four/qc.html --measure volume --jobs 4 --json=4.jsonl --quiet 2>/dev/null || [ $? -eq 3 ]
cmp four/qc.html qc.html
sed "s,four/,," 4.jsonl | cmp - 1.jsonl
python3 - <<'P'
import json, re
from check import *
page = open("qc.html").read()
expect("<script" not in page and "<img src" not in page and "\x1b" not in page and "http" not in page, "the page is text and pictures alone")
expect(page.count("data:image/png;base64,") == 4 and page.count("class=bad") == 11)
expect("&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;\\n\\x1b[31m.mha" in page)
lines = [json.loads(line) for line in open("1.jsonl")]
expect(len(lines) == 15 and [j["status"] for j in lines[:4]] == [0] * 4, lines)
expect(all((j["error"] is None) == (j["status"] == 0) for j in lines) and {j["status"] for j in lines[4:]} <= {3, 5, 6}, lines)
expect([j["input"] for j in lines[:4]] == ["in/b%d.mha" % i for i in range(4)] and
       lines[0]["volume"] > lines[3]["volume"] > lines[2]["volume"] > lines[1]["volume"] > 0, lines[:4])
P
# a panel has the pixels of the picture
isorender in/b1.mha b1.png --resolution 256x256 --fit box --quiet
python3 - <<'P'
import json
from check import *
expect(Png([json.loads(line) for line in open("1.jsonl")][1]["picture"]).rows == Png("b1.png").rows)
P
# what changed is drawn again, what is the same is not; the sheet has the bytes of a fresh one
python3 -c 'from check import *; ball("in/b2.mha", radius=3.0)'
rm in/x*.mha in/x*.nrrd in/x*.gz
isorender sheet in/b*.mha -o qc.html --measure volume 2>said
grep -q 'wrote qc.html: 4 panels, 1 drawn, 3 kept, 0 failed' said
[ "$(ls qc-panels | wc -l)" -eq 4 ]
mkdir fresh
isorender sheet in/b*.mha -o fresh/qc.html --measure volume --quiet
cmp qc.html fresh/qc.html
isorender sheet in/b*.mha -o qc.html --measure volume --isovalue 300 2>said
grep -q '4 drawn, 0 kept' said
# a run that is killed leaves no sheet, and what it has drawn is not drawn again
rm -r qc.html qc-panels
isorender sheet in/b0.mha in/b1.mha -o qc.html --measure volume --quiet
rm qc.html
isorender sheet in/b*.mha -o qc.html --measure volume 2>said
grep -q '2 drawn, 2 kept' said
cmp qc.html fresh/qc.html
# pictures: panels where the grid has them, names and numbers below, a red panel
isorender sheet in/b*.mha in/missing.mha -o qc.png --resolution 100x80 --panel-columns 2 --quiet --jobs 1 2>/dev/null || [ $? -eq 3 ]
isorender sheet in/b*.mha in/missing.mha -o qc4.png --resolution 100x80 --panel-columns 2 --quiet --jobs 4 2>/dev/null || [ $? -eq 3 ]
cmp qc.png qc4.png
isorender in/b3.mha b3.png --resolution 100x80 --fit box --quiet
isorender sheet in/b*.mha -o qc.pdf --resolution 100x80 --measure parts --quiet
# one framing: the pictures of --same-view
isorender sheet in/b0.mha in/b1.mha -o same.html --same-view --json --quiet >same.jsonl
isorender in/b0.mha in/b1.mha --output 'own-{model}.png' --same-view --resolution 256x256 --quiet
python3 - <<'P'
import json
from check import *
page, one = Png("qc.png"), Png("b3.png")
margin, band = 8, 0
found = [(x, y) for y in range(page.height - 80) for x in range(page.width - 100) if page.rows[y][x:x + 100] == one.rows[0] and
         [row[x:x + 100] for row in page.rows[y:y + 80]] == one.rows]
expect(any(x > 100 and y > 80 for x, y in found), found[:3])
red = sum(p[:3] == (0xB3, 0x26, 0x1E) for row in page.rows for p in row)
expect(6000 < red < 8000, red)
for line in open("same.jsonl"):
    j = json.loads(line)
    expect(Png(j["picture"]).rows == Png("own-%s.png" % j["input"][3:5]).rows, j)
P
# a BIDS folder: its T1w images, of sessions too, each with the mask of the same entities, in the same place or a derivative's
python3 - <<'P'
import os
from check import *
for name in ("sub-01/anat", "sub-02/ses-1/anat", "derivatives/brains/sub-01/anat", "sub-01/func"):
    os.makedirs("in/bids/" + name)
open("in/bids/dataset_description.json", "w").write("{}")
def image(name, inside):
    value = lambda x, y, z: inside * (((x - 12) ** 2 + (y - 12) ** 2 + (z - 12) ** 2) ** 0.5 < inside)
    data = b"".join(struct.pack("<h", int(value(x, y, z))) for z in range(24) for y in range(24) for x in range(24))
    header = bytearray(nifti_header((24, 24, 24), 4, 16)) + bytes(4)
    struct.pack_into("<f", header, 108, 352.0)
    header[344:348] = b"n+1\0"
    open("in/bids/" + name, "wb").write(bytes(header) + data)
import struct
image("sub-01/anat/sub-01_T1w.nii", 9)
image("sub-01/anat/sub-01_T2w.nii", 9)
image("sub-01/func/sub-01_bold.nii", 9)
image("sub-02/ses-1/anat/sub-02_ses-1_T1w.nii", 8)
image("derivatives/brains/sub-01/anat/sub-01_desc-brain_mask.nii", 5)
P
isorender sheet in/bids -o bids.html --isovalue 4 --json --quiet >bids.jsonl
isorender in/bids/sub-01/anat/sub-01_T1w.nii masked.png --labels in/bids/derivatives/brains/sub-01/anat/sub-01_desc-brain_mask.nii \
    --opacity 0.3 --isovalue 4 --fit box --resolution 256x256 --quiet
python3 - <<'P'
import json
from check import *
one, two = map(json.loads, open("bids.jsonl"))
expect(one["input"] == "in/bids/sub-01/anat/sub-01_T1w.nii" and one["beside"].endswith("brains/sub-01/anat/sub-01_desc-brain_mask.nii"), one)
expect(two["input"] == "in/bids/sub-02/ses-1/anat/sub-02_ses-1_T1w.nii" and two["beside"] is None, two)
expect(Png(one["picture"]).rows == Png("masked.png").rows)
P
mkdir in/none && echo '{}' >in/none/dataset_description.json
refuses 6 "a BIDS folder without images" isorender sheet in/none -o bad.html || exit 1
# a process that is killed takes only its own panel with it
python3 - <<'P'
import glob, os, signal, subprocess, time
from check import *
p = subprocess.Popen(["isorender", "sheet", "scene:gyroid:500", "in/b1.mha", "-o", "killed.html", "--jobs", "1", "--json", "--quiet"],
                     stdout=subprocess.PIPE, stderr=subprocess.PIPE)
children, ticks = [], 0
while ticks < 20: # until the child has drawn for a while
    expect(p.poll() is None, "it was too fast")
    try:
        children = [int(c) for name in glob.glob("/proc/%d/task/*/children" % p.pid) for c in open(name).read().split()]
        ticks = sum(map(int, open("/proc/%d/stat" % children[0]).read().split(")")[1].split()[11:13]))
    except (OSError, IndexError):
        time.sleep(0.01)
os.kill(children[0], signal.SIGKILL)
out, err = p.communicate(timeout=60)
expect(p.returncode == 3 and b"scene:gyroid:500: the process that drew it has ended early" in err and
       out.count(b'"status": 0') == 1, p.returncode, out, err)
P
refuses 2 "needs a name" isorender sheet in/b0.mha || exit 1
refuses 2 "no inputs" isorender sheet -o bad.html || exit 1
refuses 2 "a contact sheet is a .html" isorender sheet in/b0.mha -o bad.mp4 || exit 1
refuses 2 "sheet cannot be combined with --mesh" isorender sheet in/b0.mha -o bad.html --mesh bad.stl || exit 1
refuses 2 "overwrite the input" isorender sheet in/b0.mha -o in/b0.mha || exit 1
refuses 2 "--layers" isorender sheet in/b0.mha -o bad.html --layers 1 || exit 1
OMPI_MCA_orte_tmpdir_base="$PWD/in" OMPI_COMM_WORLD_SIZE=2 refuses 2 "without mpirun" isorender sheet in/b0.mha -o bad.html || exit 1
refuses 2 "jobs is for sheets" isorender in/b0.mha bad.png --jobs 2 || exit 1
refuses 2 "measure is for sheets" isorender in/b0.mha bad.png --measure area || exit 1
refuses 7 "nowhere" isorender sheet in/b0.mha -o nowhere/bad.html || exit 1
refuses 5 "at most 16384 a side" isorender sheet in/b*.mha -o bad.png --resolution 16000x100 || exit 1
