# A label of a segmentation is sculpted and goes back into a copy of its own file: without strokes every byte is the same, whatever
# the type, order and compression; with strokes voxels change within the brush's reach only, the label's and those it takes; the
# same bytes for threads and instruction sets, and for the strokes of such a session played again.
cat >in/make.py <<'P'
import gzip, json, math, struct
n = (40, 36, 20) # coarse along z, oblique, flipped: boxes 3 and 7 share a face, the ball 100 touches neither
c, s = math.cos(0.4), math.sin(0.4)
axes, origin = [(c, s, 0), (s, -c, 0), (0, 0, 2)], (10, -4, 3) # LPS
def world(x, y, z): return [origin[i] + x * axes[0][i] + y * axes[1][i] + z * axes[2][i] for i in range(3)]
def value(x, y, z):
    if 8 <= y < 20 and 4 <= z < 12 and 6 <= x < 26: return 3 if x < 16 else 7
    return 100 if (x - 30.2)**2 + (y - 28.7)**2 + 4 * (z - 12.4)**2 < 36 else 0
labels = [value(x, y, z) for z in range(n[2]) for y in range(n[1]) for x in range(n[0])]
codes = {"b": (256, "int8"), "B": (2, "uint8"), "h": (4, "int16"), "H": (512, "uint16"), "i": (8, "int32"), "f": (16, "float"), "d": (64, "double")}
def put(path, whole): open(path, "wb").write(gzip.compress(whole, 9) if path.endswith(".gz") else whole)
def nifti(path, code, order="<", slope=1.0, volumes=1, behind=b"", version=1):
    head = bytearray(352 if version == 1 else 544)
    forms = [[sign * a[row] for a in axes] + [sign * origin[row]] for row, sign in enumerate((-1, -1, 1))]
    dims, spacings = (3 + (volumes > 1), *n, volumes, 1, 1, 1), (1, 1, 1, 2, 1, 1, 1, 1)
    size = struct.calcsize(code)
    struct.pack_into(order + "i", head, 0, 348 if version == 1 else 540)
    if version == 1:
        struct.pack_into(order + "8h", head, 40, *dims)
        struct.pack_into(order + "2h", head, 70, codes[code][0], 8 * size)
        struct.pack_into(order + "8f3f", head, 76, *spacings, 352, slope, 0)
        head[123:124], head[148:158], head[344:348] = b"\2", b"made by us", b"n+1\0"
        struct.pack_into(order + "2h", head, 252, 0, 1)
        for row in range(3): struct.pack_into(order + "4f", head, 280 + 16 * row, *forms[row])
    else:
        head[4:12] = b"n+2\0\r\n\032\n"
        struct.pack_into(order + "2h8q", head, 12, codes[code][0], 8 * size, *dims)
        struct.pack_into(order + "8dq2d", head, 104, *spacings, 544, slope, 0)
        struct.pack_into(order + "2i", head, 344, 0, 1)
        for row in range(3): struct.pack_into(order + "4d", head, 400 + 32 * row, *forms[row])
        struct.pack_into(order + "i", head, 500, 2)
    put(path, bytes(head) + struct.pack(order + "%d" % len(labels) + code, *labels) * volumes + behind)
def nrrd(path, code, encoding="raw", endian="little", layers=0, more=""):
    head = "NRRD0004\n# kept\ntype: %s\ndimension: %d\nspace: left-posterior-superior\n" % (codes[code][1], 3 + layers)
    head += "sizes: %s%d %d %d\nspace directions: %s" % ("2 " * layers, *n, "none " * layers)
    head += " ".join("(%r,%r,%r)" % a for a in axes) + "\nkinds: " + "list " * layers + "domain domain domain\n"
    head += "space origin: (%r,%r,%r)\nencoding: %s\nendian: %s\n%s" % (*origin, encoding, endian, more)
    for i, (v, name, layer) in enumerate([(3, "left box", 0), (7, "right box", layers), (100, "Ball", 0)]):
        head += "Segment%d_LabelValue:=%d\nSegment%d_Layer:=%d\nSegment%d_Name:=%s\n" % (i, v, i, layer, i, name)
    values = [x for v in labels for x in (3 if v == 7 else v, 7 if v == 7 else 0)] if layers else labels
    data = struct.pack("<>"[endian == "big"] + "%d" % len(values) + code, *values)
    if encoding == "text": data = " ".join(map(str, values)).encode()
    open(path, "wb").write(head.encode() + b"\n" + (gzip.compress(data) if encoding == "gzip" else data))
if __name__ == "__main__":
    for code in codes: nifti("in/%s.nii" % codes[code][1], code)
    nifti("in/a.nii.gz", "B")
    nifti("in/big.nii", "H", ">")
    nifti("in/two.nii.gz", "h", version=2)
    nifti("in/slope.nii", "B", slope=2.0)
    nifti("in/four.nii.gz", "h", volumes=2, behind=b"behind")
    nrrd("in/a.seg.nrrd", "B", "gzip")
    nrrd("in/big.nrrd", "h", endian="big")
    nrrd("in/layers.seg.nrrd", "B", "gzip", layers=1)
    nrrd("in/text.nrrd", "B", "text")
    nrrd("in/apart.nhdr", "B", more="data file: big.nrrd\n")
    head = "ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementSpacing = 1 1 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    open("in/a.mha", "wb").write((head % n).encode() + bytes(labels))
P
cat >in/label_files.py <<'P'
# What changed between two segmentations: kind of file, before, after, component and number of components.
import sys; sys.path.insert(0, "in")
import gzip, json, struct
from make import *
def bytes_of(path):
    whole = open(path, "rb").read()
    if path.endswith(".gz"): return gzip.decompress(whole)
    at = whole.find(b"\n\n") + 2
    return whole[:at] + gzip.decompress(whole[at:]) if b"encoding: gzip" in whole[:at] else whole
def compare(before, after, reach, centres, others=1, own=0, report=None):
    a, b = bytes_of(before), bytes_of(after)
    assert len(a) == len(b), (before, len(a), len(b))
    count = len(labels) * others
    start = len(a) - count
    assert a[:start] == b[:start], before
    added = removed = 0
    taken = {}
    for i in range(count):
        if a[start + i] == b[start + i]: continue
        assert i % others == own, (before, i)
        voxel = i // others
        at = world(voxel % n[0], voxel // n[0] % n[1], voxel // n[0] // n[1])
        far = min(sum((p - q)**2 for p, q in zip(at, c))**0.5 for c in centres)
        assert far <= reach, (before, voxel, far)
        old, new = a[start + i], b[start + i]
        if new == 7: added += 1; taken[str(old)] = taken.get(str(old), 0) + 1
        else: assert old == 7 and new == 0, (old, new); removed += 1
    r = json.load(open(report))["label"]
    assert r == {"value": 7, "added": added, "removed": removed, "taken_from": taken}, (r, added, removed, taken)
    return added, removed, taken
P
python3 in/make.py || exit 1
same() { cmp <(zcat -f "$1") <(zcat -f "$2"); }
for file in in/*8.nii in/*16.nii in/*32.nii in/float.nii in/double.nii in/big.nii in/a.nii.gz in/two.nii.gz in/big.nrrd in/a.mha; do
    end=${file#*.}
    isosculpt --open $file --label 7 --headless --output out.$end --quiet && same $file out.$end || exit 1
done
isosculpt --open in/four.nii.gz --label 7 --component 1 --headless --output o.nii.gz --quiet && same in/four.nii.gz o.nii.gz || exit 1
for file in a layers; do
    isosculpt --open in/$file.seg.nrrd --label 'RIGHT*' --headless --output same.seg.nrrd --quiet || exit 1
    python3 -c 'import sys; sys.path.insert(0, "in"); from label_files import *; assert bytes_of(sys.argv[1]) == bytes_of(sys.argv[2])' in/$file.seg.nrrd same.seg.nrrd || exit 1
done
cat >in/strokes_of.py <<'P'
import sys; sys.path.insert(0, "in")
from strokes import *
from make import world
import json
centres = [world(21, 20, 8), world(16, 14, 11.5), world(25.5, 8.5, 5)]
events = []
for tool, at in zip(("add", "add", "carve"), centres):
    events += [begin({"at": at}, tool=tool, radius=3.0), {"event": "end"}]
def journal(path, source, reading, report):
    r = json.load(open(report))
    write(path, events, header(version=2, source=source, source_crc=crc32c(open(source, "rb").read()), radius=0.0, reading=reading,
                               dims=r["dims"], voxel_size=r["voxel_size"], origin=[0.0] * 3))
if __name__ == "__main__":
    write("in/any.strokes", events)
P
python3 in/strokes_of.py || exit 1
play() { isosculpt --open "$1" --label "$2" --replay in/any.strokes --headless --output "$3" --json=r.json --quiet "${@:4}"; }
changed='import sys; sys.path.insert(0, "in"); from label_files import *; from strokes_of import centres
added, removed, taken = compare(*sys.argv[1:3], 3.0 + 1.0, centres, *map(int, sys.argv[3:5]), report="r.json")
assert added > 40 and removed > 10 and taken.get("3", 0) > 5 and taken.get("0", 0) > 20, (added, removed, taken)'
play in/a.nii.gz 7 a.nii.gz && python3 -c "$changed" in/a.nii.gz a.nii.gz 1 0 || exit 1
play in/a.seg.nrrd 'right box' a.seg.nrrd && python3 -c "$changed" in/a.seg.nrrd a.seg.nrrd 1 0 || exit 1
play in/uint8.nii 7 u.nii --threads 1 && same a.nii.gz u.nii || exit 1
for cpu in generic avx2 avx512; do ISO_CPU=$cpu play in/a.nii.gz 7 $cpu.nii.gz --threads 2 && cmp a.nii.gz $cpu.nii.gz || exit 1; done
play in/a.nii.gz 7 cut.nii.gz --crop 0,39,0,35,0,15 && same a.nii.gz cut.nii.gz || exit 1
play in/a.nii.gz 7 fine.nii.gz --voxel-size 0.6 && python3 -c "$changed" in/a.nii.gz fine.nii.gz 1 0 || exit 1
# the strokes of such a session name the label, by number; the file may lie beside them
isosculpt --open in/a.nii.gz --label 7 --headless --output s.vdb --json=r0.json --quiet || exit 1
python3 -c 'import sys; sys.path.insert(0, "in"); from strokes_of import *
journal("in/own.strokes", "in/a.nii.gz", "label=7\n", "r0.json")' || exit 1
isosculpt --replay in/own.strokes --headless --output own.nii.gz --quiet && cmp a.nii.gz own.nii.gz || exit 1
# TIFF, also compressed
python3 - <<'P' || exit 1
import sys, zlib; sys.path.insert(0, "in")
import struct
from make import labels, n
from strokes import *
from tiff_files import tiff
planes = [bytes(labels[z * n[0] * n[1]:(z + 1) * n[0] * n[1]]) for z in range(n[2])]
tiff("in/a.tif", n[:2], planes, headers="last")
tiff("in/wide.tif", n[:2], [struct.pack("<%dH" % len(p), *p) for p in planes], bits=16, headers="last")
tiff("in/between.tif", n[:2], planes)
tiff("in/packed.tif", n[:2], planes, headers="last", pack=zlib.compress)
write("in/cells.strokes", [begin({"at": [21, 20, 8]}, tool="add", radius=3.0), {"event": "end"}])
P
for file in a wide between packed; do
    isosculpt --open in/$file.tif --label 7 --headless --output $file.tif --quiet && cmp in/$file.tif $file.tif || exit 1
    isosculpt --open in/$file.tif --label 7 --replay in/cells.strokes --headless --output $file.tif --json=r.json --quiet || exit 1
done
python3 - <<'P' || exit 1
import json, sys; sys.path.insert(0, "in")
from make import labels, n
before, after, report = open("in/a.tif", "rb").read(), open("a.tif", "rb").read(), json.load(open("r.json"))["label"]
at = before.index(bytes(labels))
changed = [i - at for i in range(len(before)) if before[i] != after[i]]
assert len(before) == len(after) and len(changed) == report["added"] > 40 and report["removed"] == 0, (len(changed), report)
for i in changed:
    x, y, z = i % n[0], i // n[0] % n[1], i // n[0] // n[1]
    assert after[at + i] == 7 and (x - 21)**2 + (y - 20)**2 + (z - 8)**2 < 16, (x, y, z)
wide = [open(name, "rb").read() for name in ("in/wide.tif", "wide.tif")]
other = [i for i in range(len(wide[0])) if wide[0][i] != wide[1][i]]
assert [(i - other[0]) // 2 for i in other] == [i - changed[0] for i in changed]
P
# what cannot be done is said, and nothing is written
fails() { refuses "$1" "$2" isosculpt "${@:3}" --headless || exit 1; }
fails 2 "there is no label 5: there are 3, 7, 100" --open in/a.nii.gz --label 5 --output bad.nii.gz
fails 2 "label liver is neither the number of a label nor a name" --open in/a.seg.nrrd --label liver --output bad.seg.nrrd
fails 2 "is the name of several labels" --open in/a.seg.nrrd --label '*box' --output bad.seg.nrrd
fails 2 "the name must end as in" --open in/a.nii.gz --label 7 --output bad.nrrd
fails 2 "the name must end as in" --open in/a.nii.gz --label 7 --output bad.nii
fails 2 "its values are scaled (scl_slope" --open in/slope.nii --label 14 --output bad.nii
fails 2 "cannot be written again: voxels go back into .nii" --open in/text.nrrd --label 7 --output bad.nrrd
fails 2 "only a label that was opened by --label" --replay "$volumes/bear.strokes" --output bad.nii.gz
printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >in/tetra.obj
fails 2 "is a mesh: --label needs a volume" --open in/tetra.obj --label 7 --output bad.vdb
fails 2 "--label and --isovalue" --open in/a.nii.gz --label 7 --isovalue 3 --output bad.vdb
fails 2 "--label needs a file" --replay in/own.strokes --label 7 --output bad.vdb
fails 2 "--label-table is for --label" --open in/a.nii.gz --label-table in/none --output bad.vdb
fails 3 "in/none" --open in/a.nii.gz --label x --label-table in/none --output bad.vdb
python3 -c 'from check import *; ball("in/ball.mha")' || exit 1
fails 3 "not a segmentation" --open in/ball.mha --label 3 --output bad.mha
cp in/a.nii.gz in/keep.nii.gz
isosculpt --open in/a.nii.gz --label 7 --headless --output in/a.nii.gz 2>said && exit 1
grep -q "in/a.nii.gz" said && cmp in/a.nii.gz in/keep.nii.gz || exit 1
head -c 300 in/a.nii.gz >in/short.nii.gz
fails 3 "in/short.nii.gz" --open in/short.nii.gz --label 7 --output bad.nii.gz
