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

def mif(name, layout=("+0", "+1", "+2"), kind="Float32LE", code="<f", copies=1, more="", beside=None, what=value):
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
                values[place] = what(x, y, z)
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
def bits(name, layout=("+0", "+1", "+2"), copies=1, of=lambda x, y, z: value(x, y, z) > 50):
    mif("tmp.mif", layout, "UInt8", "<B", copies, what=of)
    whole = open("in/tmp.mif", "rb").read()
    head, data = whole[:whole.index(b"END\n")], whole[512:]
    packed = bytes(sum((data[i + k] > 0) << 7 - k for k in range(8) if i + k < len(data)) for i in range(0, len(data), 8))
    write(name, (head.replace(b"UInt8", b"Bit") + b"END\n").ljust(512, b"\0") + packed)

bits("bits.mif")
bits("bits_apart.mif.gz", ("+0", "-1", "+2", "+3"), 3)
mif("mask.mif", kind="UInt8", code="<B", what=lambda x, y, z: value(x, y, z) > 50)
bits("bits_together.mif", ("+1", "+2", "+3", "+0"), 2)
mif("between.mif", layout=("+0", "+1", "+3", "+2"), copies=3)

# AFNI: attributes beside the voxels; oblique, or with an orientation, origin and steps alone; sub-bricks with factors
rows = [(1.2, -0.6, 0.0, 7.0), (0.9, 0.8, 0.0, -2.0), (0.0, 0.0, 2.0, 3.0)]
nrrd("afni.nrrd", "left-posterior-superior", [[rows[i][a] for i in range(3)] for a in range(3)], [r[3] for r in rows])
nrrd("asl.nrrd", "left-posterior-superior", [(0, 0, -1.5), (1.0, 0, 0), (0, -2.0, 0)], (-20.0, 5.0, 10.0))

def afni(name, kind=1, code="<h", bricks=1, factor=0, oblique=True, brik=".BRIK", swap=None):
    attribute = lambda kind, name, *v: "\ntype = %s-attribute\nname = %s\ncount = %d\n %s\n" % (kind, name, len(v), " ".join(map(str, v)))
    head = "\ntype = string-attribute\nname = BYTEORDER_STRING\ncount = 10\n'%s_FIRST~\n" % ("MSB" if code[0] == ">" else "LSB")
    head += attribute("integer", "DATASET_RANK", 3, bricks, 0, 0) + attribute("integer", "DATASET_DIMENSIONS", *N, 0, 0)
    head += attribute("integer", "BRICK_TYPES", *[kind] * bricks) + attribute("float", "BRICK_FLOAT_FACS", *[0] * (bricks - 1), factor)
    if oblique:
        head += attribute("float", "IJK_TO_DICOM_REAL", *[v for r in rows for v in r])
    else:
        head += attribute("integer", "ORIENT_SPECIFIC", 5, 1, 2) + attribute("float", "ORIGIN", 10, -20, 5) + attribute("float", "DELTA", -1.5, 1, -2)
    values = [value(x, y, z) / (factor or 1) for z in range(N[2]) for y in range(N[1]) for x in range(N[0])]
    if code[1] in "hBi":
        values = list(map(round, values))
    open("in/%s.HEAD" % name, "w").write(head)
    data = struct.pack("%s%d%s" % (code[0], len(values) * bricks, code[1]), *[0] * len(values) * (bricks - 1), *values)
    open("in/" + name + brik, "wb").write(gzip.compress(data) if brik.endswith("gz") else data)

afni("short+orig")
afni("big+orig", code=">h", brik=".BRIK.gz")
afni("float+tlrc", 3, "<f", bricks=3)
afni("scaled+orig", 3, "<f", bricks=2, factor=0.25)
afni("bytes", 0, "<B", oblique=False)
afni("complex", 5, "<f")

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
# VASP: values times the volume of the cell, the first axis the fastest; two atoms of carbon, 1 and 3.5 along z
nrrd("vasp.nrrd", "3D-right-handed", steps, (0, 0, 0))
def vasp(name, scale=1.0, names=True, dynamics=False, cartesian=False, factor=None):
    cell = [tuple(c * n / scale for c in s) for s, n in zip(steps, N)]
    (a, b, c), (d, e, f), (g, h, i) = steps
    volume = factor or abs(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) * N[0] * N[1] * N[2]
    rows = ["density", "%r" % scale] + ["%.15f %.15f %.15f" % e for e in cell] + (["C_pv  H"] if names else []) + ["2 1"]
    rows += (["Selective dynamics"] if dynamics else []) + (["Cartesian"] if cartesian else ["Direct"])
    direct = [(0.0, 0.0, 0.0), (0.0, 0.5, 0.5), (0.5, 0.5, 0.5)]
    for p in direct:
        at = [sum(p[k] * cell[k][i] for k in range(3)) for i in range(3)] if cartesian else p
        rows.append("%.12f %.12f %.12f" % tuple(at) + (" T T F" if dynamics else ""))
    values = [value(x, y, z) * volume for z in range(N[2]) for y in range(N[1]) for x in range(N[0])]
    rows += ["", "%d %d %d" % N] + [" ".join("%.11E" % v for v in values[i:i + 5]) for i in range(0, len(values), 5)]
    open("in/" + name, "w").write("\n".join(rows + ["augmentation occupancies 1 2", "0.1 0.2"]) + "\n")

vasp("CHGCAR")
vasp("old.vasp", scale=2.5, names=False, dynamics=True, cartesian=True)
vasp("LOCPOT", factor=1)
head = "# from APBS\nobject 1 class gridpositions counts %d %d %d\norigin %r %r %r\n" % (*N, *ORIGIN)
head += "".join("delta %r %r %r\n" % s for s in steps) + "object 2 class gridconnections counts %d %d %d\n" % N
items = N[0] * N[1] * N[2]
open("in/apbs.dx", "w").write(head + "object 3 class array type double rank 0 items %d data follows\n" % items + text() +
                              'attribute "dep" string "positions"\n')
last_fastest = [value(x, y, z) for x in range(N[0]) for y in range(N[1]) for z in range(N[2])]
for name, kind, order, code in (("lsb.dx", "float", "lsb", "<%df"), ("msb.dx", "double", "msb", ">%dd")):
    line = "object 3 class array type %s rank 0 items %d %s ieee data follows\n" % (kind, items, order)
    open("in/" + name, "wb").write((head + line).encode() + struct.pack(code % items, *last_fastest))
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
for file in short+orig.HEAD short+orig.BRIK big+orig.HEAD big+orig.BRIK.gz; do same afni.nrrd $file; done
same afni.nrrd float+tlrc.HEAD --component 2
same afni.nrrd scaled+orig.HEAD --component 1
same asl.nrrd bytes.HEAD
if python3 -c 'import nibabel' 2>/dev/null; then # the same matrix and values
    for file in short+orig big+orig float+tlrc scaled+orig bytes; do
        isorender in/$file.HEAD --info --json=a.json >/dev/null 2>&1
        python3 -c 'from check import *
import nibabel, numpy
image, info = nibabel.load(sys.argv[1]), report("a.json")["volume"]
ours = numpy.array(info["direction"]).reshape(3, 3) * info["spacing"]
expect(numpy.allclose(image.affine[:3, :3] * [[-1], [-1], [1]], ours, atol=1e-5), image.affine, ours)
expect(numpy.allclose(image.affine[:3, 3] * [-1, -1, 1], info["origin"], atol=1e-5), image.affine, info["origin"])
data = numpy.asarray(image.dataobj).reshape(*info["dims"], -1)[..., info["component"]]
expect(numpy.allclose([data.min(), data.max()], report("a.json")["value_range"]), report("a.json")["value_range"])' in/$file.HEAD
    done
fi
mask() { isorender "in/$1" "$2" --isovalue 0.5 --resolution 90x90 --azimuth 30 --elevation 20 --quiet "${@:3}"; }
mask mask.mif a.png
mask bits.mif b.png
mask bits_apart.mif.gz c.png --component 2
python3 -c 'from check import *
expect(Png("a.png").rows == Png("b.png").rows == Png("c.png").rows, "bits, also of a later volume")'
for file in bohr.cube angstrom.cub apbs.dx lsb.dx msb.dx; do same cube.nrrd $file; done
same cube.nrrd orbitals.cube --component 2
for file in CHGCAR old.vasp LOCPOT; do same vasp.nrrd $file; done
(cd in && isorender CHGCAR --info 2>&1 | grep -q 'chgcar')
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

isorender_refuses 3 'in/bits_together.mif: not a readable MRtrix image: a mask whose volumes lie within' in/bits_together.mif
isorender_refuses 3 'in/between.mif: not a readable MRtrix image: an order of its axes that is not read' in/between.mif
head -c 1500 in/lsb.dx >in/cut.dx
isorender_refuses 3 'in/cut.dx: truncated: 1500 of ' in/cut.dx
sed 's/type float/type string/' in/lsb.dx >in/string.dx
isorender_refuses 3 'in/string.dx: not a readable OpenDX grid: binary values of a type that is not read' in/string.dx
isorender_refuses 3 'in/complex.HEAD: not a readable AFNI dataset: complex values' in/complex.HEAD
mv in/bytes.BRIK in/lost.BRIK
isorender_refuses 3 'in/bytes.HEAD: its voxels, in/bytes.BRIK or .gz, are missing' in/bytes.HEAD
isorender_refuses 3 'in/lost.BRIK: in/lost.HEAD: cannot read' in/lost.BRIK
head -c 500 in/short+orig.BRIK >in/cut+orig.BRIK
cp in/short+orig.HEAD in/cut+orig.HEAD
isorender_refuses 3 'in/cut+orig.HEAD: .*cut+orig.BRIK: truncated: 500 of 1008 bytes' in/cut+orig.HEAD
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
sed '2s/.*/-100/' in/CHGCAR >in/scale.vasp
isorender_refuses 3 'in/scale.vasp: not a readable file of VASP: its second line is no scale above 0' in/scale.vasp
head -n 11 in/CHGCAR >in/poscar.vasp
isorender_refuses 3 'in/poscar.vasp: truncated: the file ends in its header' in/poscar.vasp
sed '7s/.*/-1 999999999999/' in/CHGCAR >in/many.vasp
isorender_refuses 3 'in/many.vasp: not a readable file of VASP: the number of its atoms' in/many.vasp
gzip -k in/mrc.nrrd
isorender_refuses 3 'in/mrc.nrrd.gz: is a file of type nrrd that gzip has compressed: unpack it' in/mrc.nrrd.gz
# the atoms of a cube lie where its voxels say
isorender --glyphs in/bohr.cube atoms.png --resolution 60x60 --quiet --json=atoms.json
python3 -c 'from check import *
r = report("atoms.json"); box = r["bounds_world"]
expect(r["objects"][0]["glyphs"] == 2, r["objects"])
# two atoms of carbon, of radius 1.7, 2.5 bohr apart
expect(abs(box[5] - box[4] - 2.5 * 0.529177210903 - 3.4) < 0.01, box)'
for file in CHGCAR old.vasp; do
    isorender --glyphs in/$file atoms.png --resolution 60x60 --quiet --json=atoms.json
    python3 -c 'from check import *
r = report("atoms.json"); box = r["bounds_world"]
expect(r["objects"][0]["glyphs"] == 3, r["objects"])
# carbon at 0 and (0, 2.25, 7), and one (of unknown elements: three) at (6.75, 3.375, 7)
expect(abs(box[4] + 1.7) < 0.5 and abs(box[5] - 7) < 2.1 and box[1] > 7, box)' $file
done
