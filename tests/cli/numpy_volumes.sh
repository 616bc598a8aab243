# .npy arrays of three axes are volumes, also in .npz archives, z y x, in C and Fortran order and of every type; raw data of every type is read.
python3 - <<'P'
import struct
import zipfile
from check import *
dims = (9, 8, 7)

def value(x, y, z):
    return max(0, 100 - 8 * ((x - 4) ** 2 + (y - 3) ** 2 + 2 * (z - 3) ** 2))

def npy(path, descr, code, fortran=False, shape=None, values=None, big=""):
    shape = shape or dims[::-1]
    head = "{'descr': '%s', 'fortran_order': %s, 'shape': (%s), }" % (descr, fortran, ", ".join(map(str, shape)))
    head += " " * (-(11 + len(head)) % 64) + "\n"
    with open(path, "wb") as f:
        f.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode())
        f.write(struct.pack("%s%d%s" % (">" if descr[0] == ">" else "<", len(values), code), *values))

X, Y, Z = (range(n) for n in dims)
c = [value(x, y, z) for z in Z for y in Y for x in X]
f = [value(x, y, z) for x in X for y in Y for z in Z]
volume("in/same.mha", dims, value)
for descr, code in (("<f4", "f"), ("<f8", "d"), (">i2", "h"), ("|u1", "B"), ("|i1", "b"), ("<i4", "i"), ("<u8", "Q"), ("<f2", "e")):
    npy("in/c_%s.npy" % descr[1:], descr, code, values=c)
    npy("in/f_%s.npy" % descr[1:], descr, code, True, values=f)
npy("in/two.npy", "<f4", "f", shape=(*dims[::-1], 2), values=[v for p in c for v in (0, p)])
npy("in/two_f.npy", "<f4", "f", True, (*dims[::-1], 2), [0] * len(f) + f)
npy("in/five.npy", "<f4", "f", shape=(1, 1, *dims[::-1]), values=c)
npy("in/complex.npy", "<c8", "f", values=c + c)
npy("in/points.npy", "<f4", "f", shape=(400, 3), values=[((i * 7919) % 1000) / 100 for i in range(1200)])
def npz(name, *members, how=zipfile.ZIP_STORED):
    with zipfile.ZipFile("in/" + name, "w", how) as archive:
        for member in members:
            with archive.open(member + ".npy", "w", force_zip64=True) as file: # as numpy.savez does
                file.write(open("in/%s.npy" % member, "rb").read())
npz("stored.npz", "points", "c_f4", "two")
npz("deflated.npz", "points", "two", "c_i2", "f_f8", how=zipfile.ZIP_DEFLATED)
npz("flat.npz", "points")
for kind, code in (("float64", "d"), ("int32", "i"), ("uint32", "I"), ("int8", "b"), ("float32", "f"), ("uint16", "H")):
    open("in/ball_9x8x7_%s.raw" % kind, "wb").write(struct.pack("<%d%s" % (len(c), code), *c))
    open("in/%s.bin" % kind, "wb").write(b"four" + struct.pack(">%d%s" % (len(c), code), *c))
P
draw() { isorender "$1" out.png --isovalue 50.5 --resolution 80x80 --quiet --json="$2.json" "${@:3}"; cp out.png "$2.png"; }
draw in/same.mha same
for file in in/c_*.npy in/f_*.npy in/two.npy in/two_f.npy; do
    component=()
    case $file in *two*) component=(--component 1) ;; esac
    draw "$file" now "${component[@]}"
    python3 -c 'from check import *; expect(report("now.json")["image"]["hash"] == report("same.json")["image"]["hash"], sys.argv)' "$file"
done
for kind in float64 int32 uint32 int8 float32 uint16; do
    draw in/ball_9x8x7_$kind.raw named
    draw in/$kind.bin given --raw 9x8x7:$kind:big:4
    python3 -c 'from check import *
for name in ("named", "given"): expect(report(name + ".json")["image"]["hash"] == report("same.json")["image"]["hash"], sys.argv, name)' $kind
done
archive() {
    draw "$1" now "${@:2}"
    python3 -c 'from check import *; expect(report("now.json")["image"]["hash"] == report("same.json")["image"]["hash"], sys.argv)' "$@"
}
archive in/stored.npz
for file in stored deflated; do archive in/$file.npz --grid two --component 1; done
for array in c_i2 f_f8; do archive in/deflated.npz:/$array; archive in/deflated.npz --grid $array; done
draw in/same.mha same_chunks --chunk-size 16
draw in/deflated.npz now --grid c_i2 --chunk-size 16
python3 -c 'from check import *; expect(report("now.json")["image"]["hash"] == report("same_chunks.json")["image"]["hash"])'
isorender in/stored.npz --info 2>&1 | grep -q "note: several arrays: using 'c_f4' of 3 (--grid)"
isorender_refuses 2 "in/stored.npz: no array 'none', there are 'points', 'c_f4', 'two'" in/stored.npz --grid none
isorender_refuses 3 "in/flat.npz: holds no array of three axes, but 'points'" in/flat.npz
isorender_refuses 3 'in/stored.npz: has 2 axes: a volume has three' in/stored.npz --grid points
head -c -100 in/deflated.npz >in/cut.npz
isorender_refuses 3 'in/cut.npz: truncated: a ZIP archive without a directory' in/cut.npz
python3 -c '
data = bytearray(open("in/deflated.npz", "rb").read())
at = data.find(b"c_i2.npy")
data[at + 200:at + 240] = bytes(range(40))
open("in/damaged.npz", "wb").write(data)'
isorender_refuses 3 'in/damaged.npz: ' in/damaged.npz
python3 -c '
data = bytearray(open("in/deflated.npz", "rb").read())
at = data.index(b"PK\x01\x02") # the directory, entry by entry
while data[at + 46:at + 50] != b"c_i2":
    at = data.index(b"PK\x01\x02", at + 1)
data[at + 16] ^= 1
open("in/other.npz", "wb").write(data)'
isorender_refuses 3 'in/other.npz: damaged: the checksum of an array is wrong' in/other.npz --grid c_i2
isorender in/points.npy points.png --radius 0.5 --resolution 60x60 --quiet
head -c 500 in/c_f4.npy >in/cut.npy
isorender_refuses 3 'in/cut.npy: truncated' in/cut.npy
head -c 500 in/f_f4.npy >in/cut_f.npy
isorender_refuses 3 'in/cut_f.npy: truncated' in/cut_f.npy
isorender_refuses 3 'in/five.npy: has 5 axes: a volume has three' in/five.npy
isorender_refuses 3 "in/complex.npy: numbers of type '<c8' are not read" in/complex.npy
isorender_refuses 2 'the type must be uint8, int8, ' in/float64.bin --raw 9x8x7:complex
