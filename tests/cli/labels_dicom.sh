# DICOM segmentations (SEG) of all types as labels: the same pictures and measures as the same labels in .nrrd; slices that are left
# out; names and colours; segments that overlap; both byte layouts; files that cannot be such labels.
cat >in/make.py <<'P'
import array
import struct
from dicom_slices import *
N, SLICES, STEP = 22, 24, 1.5  # columns = rows - 1: bits of frames begin within bytes
ROWS = N + 1


def label(x, y, z):
    if 3 <= x < 9 and 5 <= y < 17 and 5 <= z < 17: return 3
    if 9 <= x < 16 and 5 <= y < 17 and 5 <= z < 17: return 7
    return 12 if (x - 16.2)**2 + (y - 17.7)**2 + (z - 19.4)**2 < 9 else 0


LABELS = [[label(x, y, z) for y in range(ROWS) for x in range(N)] for z in range(SLICES)]
NAMES = {3: ("left box", (53.24, 80.09, 67.2)), 7: ("right box", (100, 0, 0)), 12: ("Ball", None)}


def number(value, kind="<H"): return struct.pack(kind, value)


class writer:
    """explicit: with value representations, and lengths; else without, and with delimiters."""
    def __init__(self, explicit): self.explicit = explicit

    def element(self, group, tag, kind, value):
        if self.explicit: return dicom_element(group, tag, kind, value)
        return struct.pack("<HHI", group, tag, len(value) + len(value) % 2) + value + b" " * (len(value) % 2)

    def sequence(self, group, tag, items):
        if self.explicit:
            body = b"".join(struct.pack("<HHI", 0xFFFE, 0xE000, len(i)) + i for i in items)
            return dicom_element(group, tag, b"SQ", body)
        body = b"".join(struct.pack("<HHI", 0xFFFE, 0xE000, 0xFFFFFFFF) + i + struct.pack("<HHI", 0xFFFE, 0xE00D, 0) for i in items)
        return struct.pack("<HHI", group, tag, 0xFFFFFFFF) + body + struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)


def write(path, kind, frames, pixels, bits, explicit=True, place=None, fraction=None, segments=NAMES, padding=None, series=b"1.2.9"):
    """frames: (z, segment or None) of each."""
    w = writer(explicit)
    e, s = w.element, w.sequence
    items = []
    for value, (name, lab) in segments.items():
        item = s(0x62, 3, [e(8, 0x104, b"LO", b"Tissue")]) + e(0x62, 4, b"US", number(value)) + e(0x62, 5, b"LO", name.encode())
        if lab:
            scaled = [lab[0] / 100, (lab[1] + 128) / 255, (lab[2] + 128) / 255]
            item += e(0x62, 0xD, b"US", b"".join(number(round(65535 * v)) for v in scaled))
        items.append(item)
    groups = []
    for z, segment in frames:
        at = place(z) if place else b"10\\0\\%g" % (STEP * z)
        group = s(0x20, 0x9113, [e(0x20, 0x32, b"DS", at)]) if at else b""
        if segment is not None: group += s(0x62, 0xA, [e(0x62, 0xB, b"US", number(segment))])
        groups.append(group)
    shared = s(0x20, 0x9116, [e(0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0")])
    shared += s(0x28, 0x9110, [e(0x18, 0x50, b"DS", b"1.5") + e(0x28, 0x30, b"DS", b"1\\2")])
    body = e(8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.66.4") + e(8, 0x60, b"CS", b"SEG") + e(0x20, 0xE, b"UI", series)
    body += e(0x28, 2, b"US", number(1)) + e(0x28, 4, b"CS", b"MONOCHROME2") + e(0x28, 8, b"IS", b"%d" % len(frames))
    body += e(0x28, 0x10, b"US", number(ROWS)) + e(0x28, 0x11, b"US", number(N))
    body += b"".join(e(0x28, 0x100 + i, b"US", number(v)) for i, v in enumerate((bits, bits, bits - 1, 0)))
    if padding is not None: body += e(0x28, 0x120, b"US", number(padding))
    body += e(0x62, 1, b"CS", kind) + s(0x62, 2, items)
    if fraction: body += e(0x62, 0xE, b"US", number(fraction))
    body += s(0x5200, 0x9229, [shared]) + s(0x5200, 0x9230, groups) + e(0x7FE0, 0x10, b"OB" if bits <= 8 else b"OW", pixels)
    whole(path, b"1.2.840.10008.5.1.4.1.1.66.4", body, PLAIN if explicit else b"1.2.840.10008.1.2")


def mask(z, segment): return [int(v == segment) for v in LABELS[z]]


def packed(bits):
    bits = bits + [0] * (-len(bits) % 8)
    return bytes(sum(bits[i + k] << k for k in range(8)) for i in range(0, len(bits), 8))


full = [(z, segment) for segment in NAMES for z in range(SLICES)]
some = [(z, segment) for z in reversed(range(SLICES)) for segment in NAMES if any(mask(z, segment))]
for name, frames, explicit in ("binary", full, True), ("implicit", full, False), ("sparse", some, True):
    write("in/%s.dcm" % name, b"BINARY", frames, packed(sum((mask(z, s) for z, s in frames), [])), 1, explicit)
half = [v for z, s in full for v in (101 if m else 49 for m in mask(z, s))]
write("in/fraction.dcm", b"FRACTIONAL", full, bytes(half), 8, fraction=200)
maps = [(z, None) for z in range(SLICES)]
write("in/map.dcm", b"LABELMAP", maps, bytes(sum(LABELS, [])), 8, False)
wide = array.array("H", [v or 500 for v in sum(LABELS, [])])
write("in/map16.dcm", b"LABELMAP", maps, wide.tobytes(), 16, padding=500)
# segment 20 covers a column of voxels of 3 and of 7, and segment 21 one voxel of both
over = full + [(6, 21), (6, 20)]
cover = [int(6 <= x < 12 and y == 8) for y in range(ROWS) for x in range(N)]
one = [int(x == 8 and y == 8) for y in range(ROWS) for x in range(N)]
bits = sum((mask(z, s) for z, s in full), []) + one + cover
write("in/over.dcm", b"BINARY", over, packed(bits), 1, segments={**NAMES, 20: ("bar", None), 21: ("dot", None)})
plain = packed(sum((mask(z, s) for z, s in full), []))
write("in/kind.dcm", b"SURFACE", full, plain, 1)
write("in/nowhere.dcm", b"BINARY", full, plain, 1, place=lambda z: b"")
write("in/uneven.dcm", b"BINARY", full, plain, 1, place=lambda z: b"10\\0\\%g" % (STEP * z + 0.5 * (z == 7)))
write("in/aside.dcm", b"BINARY", full, plain, 1, place=lambda z: b"%d\\0\\%g" % (10 + 3 * (z == 7), STEP * z))
write("in/nothing.dcm", b"BINARY", [(z, None) for z, s in full], plain, 1)
write("in/short.dcm", b"BINARY", full, plain[:-9], 1)
head = "NRRD0005\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\nspace directions: (2,0,0) (0,1,0) (0,0,1.5)\n"
head += "space origin: (10,0,0)\nencoding: raw\n"
head += "".join("Segment%d_LabelValue:=%d\nSegment%d_Name:=%s\n" % (i, v, i, n[0]) for i, (v, n) in enumerate(NAMES.items()))
open("in/same.seg.nrrd", "wb").write((head % (N, ROWS, SLICES) + "\n").encode() + bytes(sum(LABELS, [])))
for z in range(16): slice_of("in/study/slice%02d.dcm" % z, z, z + 1)
write("in/study/seg.dcm", b"BINARY", full, plain, 1)
P
python3 in/make.py || exit 1
printf '3 left 255 0 0 0\n7 right 255 255 255 0\n12 ball 1 2 3 0\n' >in/lut.txt
draw() { isorender --labels "$2" "$1.png" --resolution 200x200 --json="$1.json" --quiet --table "$1.csv" "${@:3}" || echo "failed: $1"; }
for how in same.seg.nrrd binary.dcm implicit.dcm sparse.dcm fraction.dcm map.dcm map16.dcm; do draw ${how%%.*} in/$how --label-table in/lut.txt; done
draw named in/binary.dcm
draw named16 in/map16.dcm
isorender --labels in/over.dcm over.png --table over.csv 2>notes || exit 1
grep -q "note: a DICOM segmentation (BINARY) of 5 segments" notes || exit 1
grep -q "note: 6 voxels belong to several segments: the one with the greatest number is drawn there" notes || exit 1
isorender --labels in/fraction.dcm fraction.png 2>notes && grep -q "what is half or more of a segment is taken for it" notes || exit 1
# The study is still its slices, the segmentation a series of its own.
isorender in/study --info >info && grep -q "16 x 16 x 16" info || exit 1
isorender in/study/seg.dcm seg.png --smooth --label 'left box' --quiet || exit 1
refuses 3 "in/kind.dcm: a segmentation of type 'SURFACE'" isorender --labels in/kind.dcm bad.png || exit 1
refuses 3 "in/nowhere.dcm: frame 1 states no position in space" isorender --labels in/nowhere.dcm bad.png || exit 1
refuses 3 "in/uneven.dcm: its slices are not evenly spaced in one line" isorender --labels in/uneven.dcm bad.png || exit 1
refuses 3 "in/aside.dcm: its slices are not evenly spaced in one line" isorender --labels in/aside.dcm bad.png || exit 1
refuses 3 "in/nothing.dcm: frame 1 states no segment" isorender --labels in/nothing.dcm bad.png || exit 1
refuses 3 "in/short.dcm: truncated" isorender --labels in/short.dcm bad.png || exit 1
python3 - <<'P'
import csv
import json
from check import *
names = "same binary implicit fraction map map16".split()
h = {name: json.load(open(name + ".json"))["image"]["hash"] for name in names}
expect(len(set(h.values())) == 1, h)
tables = {name: [r[:3] + r[6:15] for r in csv.reader(open(name + ".csv"))] for name in names + ["sparse"]}
expect(all(t == tables["same"] for t in tables.values()), tables["same"], tables["sparse"])
for name in "named", "named16":
    labels = json.load(open(name + ".json"))["labels"]
    expect([(l["label"], l["name"]) for l in labels] == [(3, "left box"), (7, "right box"), (12, "Ball")], labels)
    channels = [int(labels[0]["color"][i:i + 2], 16) for i in (0, 2, 4)]
    expect(channels[0] >= 254 and max(channels[1:]) <= 2 and labels[1]["color"] == "FFFFFF", labels)
over = {r["label"]: int(r["voxels"]) for r in csv.DictReader(open("over.csv"))}
before = {r["label"]: int(r["voxels"]) for r in csv.DictReader(open("named.csv"))}
expect(over == {"3": before["3"] - 3, "7": before["7"] - 3, "12": before["12"], "20": 5, "21": 1}, over, before)
P
# A label of a binary segmentation is sculpted and goes back into a copy of its file, as into the same labels in .nrrd: bits of its
# frames, and of those of the segment that it takes voxels from, change; without strokes, none.
isosculpt --open in/binary.dcm --label 7 --headless --output same.dcm --quiet && cmp in/binary.dcm same.dcm || exit 1
isosculpt --open in/over.dcm --label 20 --headless --output same.dcm --quiet && cmp in/over.dcm same.dcm || exit 1
cat >in/strokes_of.py <<'P'
import sys; sys.path.insert(0, "in")
from strokes import *
def stroke(tool, at, radius): return [begin({"at": at}, tool=tool, radius=radius), {"event": "end"}]
inside = stroke("add", [41, 11, 15], 4.0) + stroke("add", [27, 11, 15], 3.5) + stroke("carve", [34, 16, 15], 3.0)
write("in/inside.strokes", inside)
write("in/above.strokes", stroke("add", [34, 11, 26], 4.0))
P
python3 in/strokes_of.py || exit 1
play() { isosculpt --open "in/$1" --label 7 --replay "in/$2.strokes" --headless --output "$3" --json="$3.json" --quiet; }
for name in binary implicit sparse; do play $name.dcm inside $name.dcm || exit 1; done
play same.seg.nrrd inside same.seg.nrrd || exit 1
python3 - <<'P' || exit 1
import json, sys; sys.path.insert(0, "in")
from make import *
def labels_of(path, before, frames):
    a, b = open(before, "rb").read(), open(path, "rb").read()
    bits = len(frames) * N * ROWS
    tail = (bits + 7) // 8 + ((bits + 7) // 8) % 2
    assert len(a) == len(b) and a[:-tail] == b[:-tail], path
    got, data = [[0] * (N * ROWS) for _ in range(SLICES)], b[-tail:]
    for f, (z, segment) in enumerate(frames):
        for i in range(N * ROWS):
            bit = f * N * ROWS + i
            if data[bit // 8] >> bit % 8 & 1:
                assert got[z][i] == 0, (path, z, i) # no voxel is in two segments
                got[z][i] = segment
    return got
size = SLICES * N * ROWS
whole = open("same.seg.nrrd", "rb").read()[-size:]
expected = [list(whole[z * N * ROWS:(z + 1) * N * ROWS]) for z in range(SLICES)]
reports = [json.load(open(name + ".json"))["label"] for name in ("same.seg.nrrd", "binary.dcm", "implicit.dcm")]
assert reports[0]["added"] > 40 and reports[0]["removed"] > 10 and reports[0]["taken_from"]["3"] > 5, reports[0]
assert all(r == reports[0] for r in reports), reports
for name in "binary", "implicit":
    assert labels_of(name + ".dcm", "in/%s.dcm" % name, full) == expected, name
# (slices without frames are no part of the volume at its ends, so that its solid ends elsewhere)
report, taken, added, removed = json.load(open("sparse.dcm.json"))["label"], {}, 0, 0
now = labels_of("sparse.dcm", "in/sparse.dcm", some)
for was, is_ in zip(sum(LABELS, []), sum(now, [])):
    added += is_ != was and is_ == 7
    removed += was == 7 and is_ == 0
    if is_ != was and is_ == 7: taken[str(was)] = taken.get(str(was), 0) + 1
assert report == {"value": 7, "added": added, "removed": removed, "taken_from": taken} and added > 40, report
P
isorender --labels binary.dcm a.png --table a.csv --quiet && isorender --labels same.seg.nrrd b.png --table b.csv --quiet && cmp a.csv b.csv || exit 1
# what has no frame to go to, or is no file of bits, is refused, and leaves no file
refuses 2 "in/sparse.dcm: segment 7 has no frame in slice" play sparse.dcm above bad.dcm || exit 1
refuses 2 "its type is not BINARY" play map.dcm inside bad.dcm || exit 1
refuses 2 "its type is not BINARY" play fraction.dcm inside bad.dcm || exit 1
[ ! -e bad.dcm ] || exit 1
