# Lines of TRX: the picture of the same lines in .tck, with numbers for each vertex and line, stored and compressed.
python3 - <<'P'
import json
import struct
import zipfile
from check import *
lines = [[(i * 3.0 + 0.25 * k, k * 2.0 - i, (k - 3) ** 2 * 0.5) for k in range(4 + i)] for i in range(6)]
flat = [c for line in lines for p in line for c in p]
nan, inf = float("nan"), float("inf")
head = b"mrtrix tracks\ndatatype: Float32LE\ncount: 6\nfile: . 100\nEND\n".ljust(100, b"\0")
open("in/a.tck", "wb").write(head + b"".join(struct.pack("<%df" % (3 * len(l) + 3), *[c for p in l for c in p], nan, nan, nan) for l in lines)
                             + struct.pack("<3f", inf, inf, inf))

def trx(name, code="f", kind="float32", offsets="uint64", end=True, packed=False, more=(), positions=True):
    starts = [sum(map(len, lines[:i])) for i in range(len(lines) + end)]
    with zipfile.ZipFile("in/" + name, "w", zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as archive:
        archive.writestr("header.json", json.dumps({"NB_VERTICES": len(flat) // 3, "NB_STREAMLINES": 6}))
        if positions:
            with archive.open("positions.3." + kind, "w", force_zip64=packed) as file:
                file.write(struct.pack("<%d%s" % (len(flat), code), *flat))
        archive.writestr("offsets." + offsets, struct.pack("<%d%s" % (len(starts), "Q" if "64" in offsets else "I"), *starts))
        archive.writestr("dpv/height.float16", struct.pack("<%de" % (len(flat) // 3), *flat[2::3]))
        archive.writestr("dps/number.uint8", bytes(range(6)))
        archive.writestr("groups/left.uint32", struct.pack("<2I", 0, 1))
        for entry in more:
            archive.writestr(*entry)

trx("plain.trx")
trx("half.trx", "e", "float16", "uint32", end=False)
trx("packed.trx", "d", "float64", packed=True)
trx("none.trx", positions=False)
trx("short.trx", more=[("dpv/few.uint8", b"abc")])
trx("odd.trx", more=[("dpv/odd.2.float32", b"abcdefghijk")])
data = open("in/plain.trx", "rb").read()
open("in/cut.trx", "wb").write(data[:1000])
open("in/damaged.trx", "wb").write(data.replace(b"PK\1\2", b"PK\1\3", 1))
P
draw() { isorender --lines "in/$1" "$1.png" --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json="$1.json" "${@:2}"; }
draw a.tck
for file in plain.trx half.trx packed.trx; do
    draw $file
    python3 -c 'from check import *
expect(report("a.tck.json")["image"]["hash"] == report(sys.argv[1])["image"]["hash"], sys.argv)' $file.json
done
isorender --lines in/packed.trx --info >info.txt 2>&1
grep -q height info.txt
grep -q number info.txt
grep -q 'groups of lines are left out' info.txt
draw plain.trx --color-by height
draw half.trx --color-by number

refuse() { isorender_refuses 3 "$1" --lines "$2"; } # TEXT FILE
refuse 'in/none.trx: not a readable .trx file: it has no array of positions' in/none.trx
refuse 'in/short.trx: not a readable .trx file: an array has not as many rows as there are vertices or lines' in/short.trx
refuse 'in/odd.trx: not a readable .trx file: the size of an array is no multiple of its rows' in/odd.trx
refuse 'in/cut.trx: truncated: a ZIP archive without a directory' in/cut.trx
refuse 'in/damaged.trx: a damaged ZIP archive: its directory' in/damaged.trx
