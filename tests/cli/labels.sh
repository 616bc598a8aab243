# Segmentations, all at once and some of them, by value, range, name; named, coloured and translucent; the same by every way to ask
# for them; the same bytes for threads and instruction sets; exact as raycast; a table, a legend, elements in --aov; beside a
# volume; in scenes; what finds a segmentation says so.
cat >in/make.py <<'P'
# A scan and labels of 40^3: two boxes that share a face (3 and 7), a ball (300) that touches neither, and one voxel (9).
import array
n = 40
labels = array.array("H", bytes(2 * n**3))
for z in range(n):
    for y in range(n):
        for x in range(n):
            v = 0
            if 6 <= x < 16 and 8 <= y < 20 and 5 <= z < 17: v = 3
            if 16 <= x < 26 and 8 <= y < 20 and 5 <= z < 17: v = 7
            if (x - 27.2)**2 + (y - 27.7)**2 + (z - 27.4)**2 < 64: v = 300
            labels[(z * n + y) * n + x] = v
labels[(35 * n + 5) * n + 5] = 9
head = "NRRD0005\ntype: %s\ndimension: 3\nspace: left-posterior-superior\nsizes: 40 40 40\nspace directions: (2,0,0) (0,1,0) (0,0,1)\n"
head += "space origin: (10,0,0)\nencoding: raw\nendian: little\n"
segments = "".join("Segment%d_LabelValue:=%d\nSegment%d_Name:=%s\nSegment%d_Color:=%s\n" % (i, v, i, name, i, color)
                   for i, (v, name, color) in enumerate([(3, "left box", "1 0 0"), (7, "right box", "0 1 0"), (300, "Ball", "0 0 1")]))
open("in/plain.nrrd", "wb").write((head % "uint16" + "\n").encode() + labels.tobytes())
open("in/named.seg.nrrd", "wb").write((head % "uint16" + segments + "\n").encode() + labels.tobytes())
floats = array.array("f", labels)
open("in/floats.nrrd", "wb").write((head % "float" + "\n").encode() + floats.tobytes())
mask = bytes(min(v, 1) for v in labels)
open("in/mask.nrrd", "wb").write((head % "uint8" + "\n").encode() + mask)
P
python3 in/make.py
printf '# FreeSurfer\n3 left-box 10 20 30 0\n7   right-box 200 100 0 0\n\n' >in/lut.txt
printf '0 background 0 0 0 0\n3 left_box 10 20 30 255\n7 right box 200 100 0 255\n300 ball 1 2 3 255\n9 dot 4 5 6 255\n' >in/slicer.ctbl
printf '    0     0    0    0        0  0  0    "Clear Label"\n    3   10   20   30        1  1  1    "left, box"\n    7  200  100    0        1  1  1    "right box"\n' >in/snap.txt
draw() { isorender "${@:2}" "$1.png" --resolution 200x200 --json="$1.json" --quiet || echo "failed: $1"; }
draw file --labels in/plain.nrrd
draw smooth in/plain.nrrd --smooth
draw floats in/floats.nrrd --smooth
draw one --labels in/plain.nrrd --threads 1
ISO_CPU=generic draw generic --labels in/plain.nrrd
for how in exact raycast mesh; do draw $how --labels in/plain.nrrd --method $how --samples 4 --camera iso; done
for how in exact raycast; do draw see-$how --labels in/plain.nrrd --label all,3:0.4,300:0.5:red --method $how; done
draw onto --labels in/plain.nrrd --label 3:0.4,7 --camera right
draw value --labels in/plain.nrrd --label 3,7
draw range --labels in/plain.nrrd --label 3-7
draw name --labels in/named.seg.nrrd --label 'LEFT BOX:0A141E' --label 'right*'
draw table --labels in/plain.nrrd --label 3,7 --label-table in/lut.txt
draw slicer --labels in/plain.nrrd --label 3,7 --label-table in/slicer.ctbl
draw snap --labels in/plain.nrrd --label 3,7 --label-table in/snap.txt
draw legend --labels in/named.seg.nrrd --legend --table t.csv
draw beside in/floats.nrrd --isovalue 200 --opacity 0.3 --labels in/named.seg.nrrd --label 3
draw mask in/mask.nrrd --smooth --color red --save-scene s.json
isorender s.json again.png --quiet && cmp mask.png again.png || exit 1
draw cap --labels in/plain.nrrd --clip 'z<10' --cap surface --camera top
draw export --labels in/named.seg.nrrd --mesh m.obj --no-image
draw stl in/mask.nrrd --smooth --mesh m.stl --no-image
draw aov --labels in/plain.nrrd --aov a.exr
isorender in/mask.nrrd m.png 2>notes && grep -q "note: this is a mask (0 and 1): --smooth" notes || exit 1
isorender scene:organs:40 --no-image --json=o.json --quiet || exit 1
python3 - <<'P'
n = 30 # an 8-bit volume of 4 labels, and a scan of few values, which is none
body = bytes((x // 8) % 4 if 5 < y < 20 else 0 for z in range(n) for y in range(n) for x in range(n))
scan = bytes((x * 7 + y * 3 + z * 5) % 90 for z in range(n) for y in range(n) for x in range(n))
head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 30 30 30\nspacings: 1 1 1\nencoding: raw\n\n"
open("in/few.nrrd", "wb").write(head + body)
open("in/scan.nrrd", "wb").write(head + scan)
P
# what names segments, as 3D Slicer writes it, is drawn as labels by itself, unless isosurfaces are asked for
isorender in/named.seg.nrrd segments.png --resolution 200x200 --json=segments.json 2>notes && grep -q "note: drawn as labels" notes || exit 1
draw segments-smooth in/named.seg.nrrd --smooth && isocompare images segments.png segments-smooth.png --fail-under psnr=100 >/dev/null || exit 1
isorender in/named.seg.nrrd segments.png --resolution 200x200 --isovalue 5 2>notes && ! grep -q "drawn as labels" notes || exit 1
isorender in/named.seg.nrrd --info >notes 2>&1 && ! grep -q "drawn as labels" notes || exit 1
draw segments-one in/named.seg.nrrd --label 'left box' && draw one-smooth in/named.seg.nrrd --smooth --label 'left box'
isocompare images segments-one.png one-smooth.png --fail-under psnr=100 >/dev/null || exit 1
# No other option turns labels into isosurfaces: it acts on the labels, or is refused by name.
isorender in/named.seg.nrrd largest.png --resolution 200x200 --largest --json=largest.json 2>notes || exit 1
grep -q "note: drawn as labels" notes && grep -q "kept [0-9]* of [0-9]* parts of the labels" notes && grep -q '"label_parts"' largest.json || exit 1
isorender --labels in/named.seg.nrrd alone.png --resolution 200x200 --largest 2>/dev/null || exit 1
isocompare images largest.png alone.png --fail-under psnr=100 >/dev/null || exit 1
refuses 2 "labels cannot be combined with --ior: .*--isovalue draws isosurfaces" isorender in/named.seg.nrrd bad.png --ior 1.5 || exit 1
refuses 2 "--points is for isosurfaces: .*--isovalue draws isosurfaces" isorender in/named.seg.nrrd bad.png --points bad.ply || exit 1
refuses 6 "no part of a label has 1e+09 mm3" isorender --quiet in/named.seg.nrrd bad.png --min-size 1e9 || exit 1
isorender in/few.nrrd m.png 2>notes && grep -q "note: these seem to be 3 labels (up to 3): --smooth" notes || exit 1
isorender in/scan.nrrd m.png --isovalue 45 2>notes && ! grep -q "smooth" notes || exit 1
# Segments of two layers that overlap.
python3 - <<'P'
n=20
v=bytearray()
for z in range(n):
    for y in range(n):
        for x in range(n):
            a = 1 if 3<x<10 and 3<y<15 and 3<z<15 else 2 if 13<x<17 and 3<y<8 and 3<z<8 else 0
            b = 1 if 7<x<15 and 3<y<15 and 3<z<15 else 0
            v += bytes([a,b])
h="NRRD0005\ntype: uint8\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 20 20 20\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\nspace origin: (0,0,0)\n"
for i,(l,k,nm) in enumerate([(0,1,"one"),(1,1,"two"),(0,2,"three")]): h+="Segment%d_LabelValue:=%d\nSegment%d_Layer:=%d\nSegment%d_Name:=%s\n"%(i,k,i,l,i,nm)
open("in/layers.seg.nrrd","wb").write(h.encode()+b"\n"+bytes(v))
P
isorender --labels in/layers.seg.nrrd m.png --table layers.csv 2>notes || exit 1
grep -q "note: segments of 2 layers, numbered in the order of the file" notes || exit 1
grep -q "note: 258 voxels belong to several segments: that of the last layer is drawn there" notes || exit 1
[ "$(cut -d, -f1-3,16 layers.csv | tail -3 | tr '\n' ';')" = "1,one,484,2;2,two,847,1 3;3,three,32,2;" ] || exit 1
isorender --labels in/plain.nrrd --label-table in/lut.txt m.png 2>notes
grep -q "note: in/lut.txt has no row for 2 labels (9, ..): coloured by number" notes || exit 1
python3 - <<'P'
import csv, json
from check import *
h = {name: json.load(open(name + ".json"))["image"]["hash"] for name in
     "file smooth floats one generic exact raycast mesh see-exact see-raycast value range table slicer snap legend".split()}
expect(h["file"] == h["smooth"] == h["floats"] == h["one"] == h["generic"], "the same picture by all ways: %s" % h)
expect(h["value"] == h["range"] and h["table"] == h["slicer"] == h["snap"] != h["value"], "%s" % h)
for name, want in ("table", "left-box"), ("slicer", "left_box"), ("snap", "left, box"):
    label = json.load(open(name + ".json"))["labels"][0]
    expect(label["label"] == 3 and label["name"] == want and label["color"] == "0A141E", "%s: %s" % (name, label))
# A third of the pixels look through one box at the opaque one behind it: one layer, as the border is that one's.
onto = json.load(open("onto.json"))["image"]
single = 2 - onto["layers"]["mean"]
expect(single > 0.3, "%g of the pixels have one layer" % single)
named = json.load(open("legend.json"))["labels"]
expect([(l["label"], l["name"], l["color"]) for l in named] ==
      [(3, "left box", "FF0000"), (7, "right box", "00FF00"), (9, "label 9", named[2]["color"]), (300, "Ball", "0000FF")], str(named))
rows = {int(r["label"]): r for r in csv.DictReader(open("t.csv"))}
ball, box = rows[300], rows[3]
expect(int(box["voxels"]) == 1440 and float(box["voxels_mm3"]) == 2880 and rows[9]["voxels"] == "1", str(box))
expect(abs(float(box["volume_mm3"]) / 2880 - 1) < 0.03, box["volume_mm3"])
expect([float(box[k]) for k in ("min_x", "max_x", "min_y", "max_y")] == [21, 41, 7.5, 19.5], str(box))
expect([float(box[k]) for k in ("center_x", "center_y", "center_z")] == [31, 13.5, 10.5], str(box))
expect(box["touches"] == "7" and rows[7]["touches"] == "3" and ball["touches"] == "", "%s %s" % (box, ball))
volume = 2 * 4 / 3 * 3.14159265 * 512
expect(abs(float(ball["volume_mm3"]) / volume - 1) < 0.01, ball["volume_mm3"])
P
[ $? -eq 0 ] || exit 1
python3 - <<'P'
# The objects of m.obj: closed, with the vertices of the shared face in common.
from collections import Counter
from check import expect
places, faces = [], {}
for line in open("m.obj"):
    kind, _, rest = line.strip().partition(" ")
    if kind == "o": faces[rest] = own = []
    if kind == "v": places.append(rest)
    if kind == "f": own.append([int(corner.split("/")[0]) - 1 for corner in rest.split()])
expect(list(faces) == ["left box", "right box", "label 9", "Ball"], list(faces))
for name, triangles in faces.items():
    edges = Counter((t[i], t[(i + 1) % 3]) for t in triangles for i in range(3))
    expect(all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items()), name)
left, right, dot, ball = [{places[i] for t in faces[name] for i in t} for name in faces]
expect(len(left & right) > 100 and not left & ball, len(left & right))
P
[ $? -eq 0 ] || exit 1
isocompare images raycast.png exact.png >same || exit 1
awk '/^pixels_differing/ { found = 1; if ($2 > 2) exit 1 } END { if (!found) exit 1 }' same || { cat same; exit 1; }
isocompare images see-raycast.png see-exact.png >same || exit 1
awk '/^pixels_differing/ { found = 1; if ($2 > 2) exit 1 } END { if (!found) exit 1 }' same || { cat same; exit 1; }
# colour by data is shown instead of the labels' colours
draw by_depth --labels in/plain.nrrd --surface-color-by depth --range 0,1e6 --colormap gray
draw by_label --labels in/plain.nrrd
isocompare images by_label.png by_depth.png >same
awk '/^pixels_differing/ { found = 1; if ($2 < 1000) exit 1 } END { if (!found) exit 1 }' same || { cat same; exit 1; }
