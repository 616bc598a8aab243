# Formats of single fields: maps (.mrc), FreeSurfer (.mgz), MRtrix (.mif), orbitals (.cube) and potentials (.dx) give the
# picture of the same voxels in NRRD, whatever the order and direction of their axes.
python3 - <<'P'
import gzip
import struct
from check import *
N = (9, 8, 7)
SPACING, ORIGIN = (1.5, 1.0, 2.0), (10.0, -20.0, 5.0)

def value(x, y, z):
    return max(0, 100 - 8 * ((x - 4) ** 2 + (y - 3) ** 2 + 2 * (z - 3) ** 2) + 5 * x - 3 * y)

def nrrd(name, space, directions, origin, dims=N, of=value):
    head = "NRRD0004\ntype: float\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\nspace: %s\n" % (*dims, space)
    head += "space directions: %s\nspace origin: (%r,%r,%r)\n\n" % (" ".join("(%r,%r,%r)" % tuple(d) for d in directions), *origin)
    data = [of(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]
    open("in/" + name, "wb").write(head.encode() + struct.pack("<%df" % len(data), *data))

def write(name, data):
    if name.endswith("gz"):
        data = gzip.compress(data)
    open("in/" + name, "wb").write(data)

def mrc(name, mode=2, code="f", order=(0, 1, 2), big=False, angles=(90, 90, 90), origin=ORIGIN, starts=(0, 0, 0), records=0,
        extra=(), stamp=True, copies=1, group=1):
    # `order`: the axes of the cell along columns, rows and sections
    e = ">" if big else "<"
    sizes = [N[a] for a in order]
    head = bytearray(1024)
    struct.pack_into(e + "10i", head, 0, sizes[0], sizes[1], sizes[2] * copies, mode, *starts, *N)
    struct.pack_into(e + "6f3i", head, 40, *[n * s for n, s in zip(N, SPACING)], *angles, *[a + 1 for a in order])
    struct.pack_into(e + "2i", head, 88, group, records)
    struct.pack_into(e + "3f", head, 196, *origin)
    if stamp:
        head[208:216] = b"MAP " + (b"\x11\x11\0\0" if big else b"\x44\x44\0\0")
    for at, word in extra:
        struct.pack_into(e + "I", head, at, word)
    data = b""
    for copy in range(copies):
        values = []
        for s in range(sizes[2]):
            for r in range(sizes[1]):
                for c in range(sizes[0]):
                    at = [0, 0, 0]
                    at[order[0]], at[order[1]], at[order[2]] = c, r, s
                    values.append(value(*at) if copy == copies - 1 else 0)
        data += struct.pack("%s%d%s" % (e, len(values), code), *values)
    write(name, bytes(head) + b"\xee" * records + data)

axes = [(SPACING[0], 0, 0), (0, SPACING[1], 0), (0, 0, SPACING[2])]
nrrd("mrc.nrrd", "3D-right-handed", axes, ORIGIN)
mrc("float.mrc")
mrc("half.map.gz", 12, "e")
mrc("short.mrc", 1, "h", big=True)
mrc("ushort.rec", 6, "H", records=160)
mrc("bytes.mrc", 0, "b", origin=(0, 0, 0))
mrc("imod.st", 0, "B", extra=((152, 1146047817), (156, 0)), stamp=False, origin=(0, 0, 0))
mrc("turned.ccp4", order=(2, 0, 1))
mrc("last.mrc", copies=3, group=401)
nrrd("zero.nrrd", "3D-right-handed", axes, (0, 0, 0))
mrc("starts.mrc", origin=(0, 0, 0), order=(1, 2, 0), starts=(4, -3, 2))
nrrd("starts.nrrd", "3D-right-handed", axes, (2 * 1.5, 4 * 1.0, -3 * 2.0))
mrc("hexagonal.map", angles=(90, 90, 120), origin=(0, 0, 0))
nrrd("hexagonal.nrrd", "3D-right-handed", [axes[0], (-0.5, 0.75 ** 0.5, 0), axes[2]], (0, 0, 0))

# FreeSurfer: coronal slices, tilted; the middle is given
tilt = [(-0.8, 0.6, 0.0), (0.0, 0.0, -1.0), (0.6, 0.8, 0.0)]
middle = (3.0, -4.0, 5.0)
first = [middle[i] - sum(tilt[a][i] * SPACING[a] * N[a] / 2 for a in range(3)) for i in range(3)]
nrrd("mgh.nrrd", "right-anterior-superior", [[c * SPACING[a] for c in tilt[a]] for a in range(3)], first)

def mgh(name, kind, code, placed=1, frames=1):
    values = [value(x, y, z) for z in range(N[2]) for y in range(N[1]) for x in range(N[0])]
    head = struct.pack(">7i h 15f", 1, *N, frames, kind, 0, placed, *SPACING, *[c for t in tilt for c in t], *middle)
    head += b"\0" * (284 - len(head))
    write(name, head + struct.pack(">%d%s" % (len(values) * frames, code), *[0] * len(values) * (frames - 1), *values))

for kind, code in ((1, "i"), (3, "f"), (4, "h"), (10, "H")):
    mgh("%s.mgz" % code, kind, code)
mgh("plain.mgh", 3, "f")
mgh("frames.mgz", 3, "f", frames=3)
mgh("unplaced.mgh", 3, "f", placed=0)
unplaced = [(-1, 0, 0), (0, 0, -1), (0, 1, 0)]
nrrd("unplaced.nrrd", "right-anterior-superior", unplaced,
     [-sum(unplaced[a][i] * N[a] / 2 for a in range(3)) for i in range(3)])

# MRtrix: axes in any order, and backwards
matrix = [(0.8, -0.6, 0.0, 7.0), (0.6, 0.8, 0.0, -2.0), (0.0, 0.0, 1.0, 3.0)]
nrrd("mif.nrrd", "right-anterior-superior", [[matrix[i][a] * SPACING[a] for i in range(3)] for a in range(3)],
     [matrix[i][3] for i in range(3)])

def mif(name, layout=("+0", "+1", "+2"), kind="Float32LE", code="<f", copies=1, more="", beside=None):
    ranks, signs = [int(l[1:]) for l in layout], [l[0] for l in layout]
    sizes = (list(N) + [copies])[:len(layout)]
    strides, step = [0] * len(layout), 1
    for rank in range(len(layout)):
        axis = ranks.index(rank)
        strides[axis], step = step, step * sizes[axis]
    values = [0] * step
    for z in range(N[2]):
        for y in range(N[1]):
            for x in range(N[0]):
                at = [x, y, z] + [copies - 1] * (len(layout) - 3)
                place = sum(s * (n - 1 - i if sign == "-" else i) for s, n, i, sign in zip(strides, sizes, at, signs))
                values[place] = value(x, y, z)
    head = "mrtrix image\ndim: %s\nvox: %s\nlayout: %s\ndatatype: %s\n" % (
        ",".join(map(str, sizes)), ",".join(map(repr, SPACING)), ",".join(layout), kind)
    head += "".join("transform: %r,%r,%r,%r\n" % row for row in matrix) + more
    data = struct.pack("%s%d%s" % (code[0], len(values), code[1]), *values)
    if beside:
        open("in/" + beside, "wb").write(b"0123" + data)
        write(name, (head + "file: %s 4\nEND\n" % beside).encode())
    else:
        write(name, (head + "file: . 512\nEND\n").encode().ljust(512, b"\0") + data)

mif("plain.mif")
mif("big.mif.gz", kind="Float32BE", code=">f")
mif("doubles.mif", kind="Float64LE", code="<d")
mif("turned.mif", layout=("-2", "+0", "-1"))
mif("apart.mif", layout=("+0", "-1", "+2", "+3"), copies=3)
mif("together.mif.gz", layout=("+2", "+1", "-3", "+0"), copies=3)
mif("header.mih", beside="voxels.dat")
mif("bits.mif", kind="Bit")
mif("between.mif", layout=("+0", "+1", "+3", "+2"), copies=3)

# cubes and OpenDX: the last axis is the fastest; two atoms of carbon
bohr = 0.529177210903
steps = [(1.5, 0.25, 0.0), (0.0, 1.0, 0.0), (0.0, -0.5, 2.0)]
nrrd("cube.nrrd", "3D-right-handed", steps, ORIGIN)

def text(orbitals=1):
    at = [(x, y, z) for x in range(N[0]) for y in range(N[1]) for z in range(N[2])]
    numbers = [v for p in at for v in [0] * (orbitals - 1) + [value(*p)]]
    return "\n".join(" ".join("%.5E" % v for v in numbers[i:i + 6]) for i in range(0, len(numbers), 6)) + "\n"

def cube(name, unit=bohr, orbitals=0):
    scaled = lambda v: "%.12f %.12f %.12f" % tuple(c / unit for c in v)
    sign = -1 if unit == 1 else 1
    rows = ["density", "written by hand", "%d %s" % (-2 if orbitals else 2, scaled(ORIGIN))]
    rows += ["%d %s" % (sign * n, scaled(s)) for n, s in zip(N, steps)]
    rows += ["6 6.0 0 0 0", "6 6.0 0 0 2.5"] + (["%d %s" % (orbitals, " ".join(map(str, range(orbitals))))] if orbitals else [])
    open("in/" + name, "w").write("\n".join(rows) + "\n" + text(orbitals or 1))

cube("bohr.cube")
cube("angstrom.cub", unit=1)
cube("orbitals.cube", orbitals=3)
head = "# from APBS\nobject 1 class gridpositions counts %d %d %d\norigin %r %r %r\n" % (*N, *ORIGIN)
head += "".join("delta %r %r %r\n" % s for s in steps) + "object 2 class gridconnections counts %d %d %d\n" % N
items = N[0] * N[1] * N[2]
open("in/apbs.dx", "w").write(head + "object 3 class array type double rank 0 items %d data follows\n" % items + text() +
                              'attribute "dep" string "positions"\n')
open("in/binary.dx", "w").write(head + "object 3 class array type float rank 0 items %d lsb ieee data follows\n" % items)
open("in/few.dx", "w").write(head + "object 3 class array type float rank 0 items %d data follows\n1 2 3\n" % (items - 1))
P
same() { # REFERENCE FILE [OPTION..]: both give one picture, from one place
    isorender "in/$1" a.png --isovalue 50.5 --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json=a.json
    isorender "in/$2" b.png --isovalue 50.5 --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json=b.json "${@:3}"
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
difference = max(abs(p - q) for row, other in zip(Png("a.png").rows, Png("b.png").rows) for s, t in zip(row, other) for p, q in zip(s, t))
expect(a["image"]["hash"] == b["image"]["hash"] or difference <= int(sys.argv[2]), sys.argv, difference)
box = lambda r: r["camera"]["focal_point"]
expect(max(abs(p - q) for p, q in zip(box(a), box(b))) < 1e-4, sys.argv, box(a), box(b))' "$2" 1
}
for file in float.mrc half.map.gz short.mrc ushort.rec; do same mrc.nrrd $file; done
same mrc.nrrd last.mrc --component 2
for file in bytes.mrc imod.st; do same zero.nrrd $file; done
isorender in/imod.st --info 2>&1 | grep -q 'old IMOD'
for file in turned.ccp4; do same mrc.nrrd $file; done
same starts.nrrd starts.mrc
same hexagonal.nrrd hexagonal.map
for file in i.mgz f.mgz h.mgz H.mgz plain.mgh; do same mgh.nrrd $file; done
same mgh.nrrd frames.mgz --component 2
same unplaced.nrrd unplaced.mgh
for file in plain.mif big.mif.gz doubles.mif turned.mif header.mih; do same mif.nrrd $file; done
for file in apart.mif together.mif.gz; do same mif.nrrd $file --component 2; done
for file in bohr.cube angstrom.cub apbs.dx; do same cube.nrrd $file; done
same cube.nrrd orbitals.cube --component 2
isorender in/bohr.cube --info >info.txt 2>&1
grep -q 'spacing .* A$' info.txt
! grep -q 'the file states none' info.txt || false
# scale bars, too: an angstrom is a tenth of a nanometre; what --unit says is converted
for file in bohr.cube apbs.dx float.mrc; do
    isorender in/$file a.png --isovalue 50.5 --resolution 90x90 --orthographic --scale-bar --quiet --json=a.json
    isorender in/$file b.png --isovalue 50.5 --resolution 90x90 --orthographic --scale-bar --quiet --json=b.json --unit nm
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
expect(a["volume"]["unit"] == "A" and "scale_bar_mm" not in a["camera"], a)
expect(Png("a.png").rows != Png("b.png").rows, "the bar is in angstrom")'
done

isorender_refuses 3 'in/bits.mif: not a readable MRtrix image: a mask of single bits: convert it (mrconvert' in/bits.mif
isorender_refuses 3 'in/between.mif: not a readable MRtrix image: an order of its axes that is not read' in/between.mif
isorender_refuses 3 'in/binary.dx: not a readable OpenDX grid: its values are binary' in/binary.dx
isorender_refuses 3 'in/few.dx: not a readable OpenDX grid: it has not as many values as points' in/few.dx
for file in float.mrc plain.mgh plain.mif; do
    head -c 1500 in/$file >in/cut_$file
    isorender_refuses 3 "in/cut_$file: truncated: 1500 of " in/cut_$file
done
head -c 1500 in/voxels.dat >in/cut.dat
sed 's/voxels.dat/cut.dat/' in/header.mih >in/cut.mih
isorender_refuses 3 'in/cut.mih: .*cut.dat: truncated: 1500 of ' in/cut.mih
for file in half.map.gz f.mgz big.mif.gz; do
    head -c -200 in/$file >in/cut_$file
    isorender_refuses 3 "in/cut_$file: truncated: " in/cut_$file
done
head -n 60 in/bohr.cube >in/cut.cube
isorender_refuses 3 'in/cut.cube: truncated: a number is missing' in/cut.cube
head -n 5 in/bohr.cube >in/short.cube
isorender_refuses 3 'in/short.cube: truncated: the file ends in its header' in/short.cube
sed '3s/^2/-9223372036854775808/' in/bohr.cube >in/many.cube
isorender_refuses 3 'in/many.cube: not a readable cube file: the number of its atoms' in/many.cube
sed 's/layout: +0/layout: +4294967295/' in/plain.mif >in/rank.mif
isorender_refuses 3 'in/rank.mif: not a readable MRtrix image: a layout in which' in/rank.mif
gzip -k in/mrc.nrrd
isorender_refuses 3 'in/mrc.nrrd.gz: is a file of type nrrd that gzip has compressed: unpack it' in/mrc.nrrd.gz
# the atoms of a cube lie where its voxels say
isorender --glyphs in/bohr.cube atoms.png --resolution 60x60 --quiet --json=atoms.json
python3 -c 'from check import *
r = report("atoms.json"); box = r["bounds_world"]
expect(r["objects"][0]["glyphs"] == 2, r["objects"])
# two atoms of carbon, of radius 1.7, 2.5 bohr apart
expect(abs(box[5] - box[4] - 2.5 * 0.529177210903 - 3.4) < 0.01, box)'
