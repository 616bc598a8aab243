# Rectilinear grids of legacy .vtk and of .vtr: with even steps the voxels as they are, else resampled to the smallest step, as linear
# interpolation has them; unstructured grids are refused with what resamples them.
python3 - <<'P'
import base64
import lzma
import struct
import zlib
from check import *
value = lambda x, y, z: 100 - 3 * (x - 4) ** 2 - 2 * (y - 3) ** 2 - 4 * (z - 5) ** 2
even = ([0.5 + i for i in range(8)], [-1 + 0.75 * i for i in range(11)], [1 + 2.0 * i for i in range(5)])
uneven = ([0, 1, 2, 3, 4.5, 6, 8], [-1 + 0.75 * i for i in range(11)], [0, 1, 3, 4, 7, 9, 9.5])

def vtk(name, axes, binary=False, kind="float", cells=False, of=value):
    code = {"float": "f", "double": "d"}[kind]
    put = lambda v, code: struct.pack(">%d%s" % (len(v), code), *v) if binary else (" ".join(map(repr, v))).encode()
    middles = [[(a + b) / 2 for a, b in zip(x, x[1:])] for x in axes] if cells else axes
    values = [float(of(x, y, z)) for z in middles[2] for y in middles[1] for x in middles[0]]
    data = b"# vtk DataFile Version 3.0\ntitle\n%s\nDATASET RECTILINEAR_GRID\nDIMENSIONS %d %d %d\n" % (
        b"BINARY" if binary else b"ASCII", *map(len, axes))
    for letter, x in zip(b"XYZ", axes):
        data += b"%c_COORDINATES %d %s\n" % (letter, len(x), kind.encode()) + put(x, code) + b"\n"
    data += b"%s_DATA %d\nSCALARS v float 1\nLOOKUP_TABLE default\n" % (b"CELL" if cells else b"POINT", len(values)) + put(values, "f") + b"\n"
    open("in/" + name, "wb").write(data)

def nrrd(name, axes, of=value):
    step = [x[1] - x[0] for x in axes]
    head = "NRRD0004\ntype: float\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\nspace: 3D-right-handed\n" % tuple(map(len, axes))
    head += "space directions: (%r,0,0) (0,%r,0) (0,0,%r)\nspace origin: (%r,%r,%r)\n\n" % (*step, *[x[0] for x in axes])
    data = [of(x, y, z) for z in axes[2] for y in axes[1] for x in axes[0]]
    open("in/" + name, "wb").write(head.encode() + struct.pack("<%df" % len(data), *data))

def between(axes): # `value` is a sum of functions of one coordinate: interpolating each interpolates it
    def along(x, at):
        i = max(k for k in range(len(x) - 1) if x[k] <= at)
        return i, (at - x[i]) / (x[i + 1] - x[i])
    def of(*p):
        total = 0
        for axis in range(3):
            i, part = along(axes[axis], p[axis])
            term = lambda v: value(*[v if k == axis else (4, 3, 5)[k] for k in range(3)]) - 100
            total += (1 - part) * term(axes[axis][i]) + part * term(axes[axis][i + 1])
        return 100 + total
    return of

def resampled(axes):
    steps = [min(b - a for a, b in zip(x, x[1:])) for x in axes]
    counts = [int(-(-(x[-1] - x[0]) * (1 - 1e-6) // s)) + 1 for x, s in zip(axes, steps)]
    return [[x[0] + (x[-1] - x[0]) * i / (n - 1) for i in range(n)] for x, n in zip(axes, counts)]

nrrd("even.nrrd", even)
vtk("text.vtk", even)
vtk("binary.vtk", even, binary=True)
vtk("double.vtk", even, binary=True, kind="double")
nrrd("cells.nrrd", [[(a + b) / 2 for a, b in zip(x, x[1:])] for x in even])
vtk("cells.vtk", even, cells=True)
nrrd("uneven.nrrd", resampled(uneven), between(uneven))
vtk("uneven.vtk", uneven)
vtk("uneven_binary.vtk", uneven, binary=True, kind="double")
middles = [[(a + b) / 2 for a, b in zip(x, x[1:])] for x in uneven]
nrrd("uneven_cells.nrrd", resampled(middles), between(middles))
vtk("uneven_cells.vtk", uneven, cells=True)
vtk("falling.vtk", (uneven[0][::-1], *uneven[1:]))
vtk("vast.vtk", ([0, 1e-9, 2e-9, 3e-9, 1e9, 2e9], *uneven[1:]))
vtk("large.vtk", [[i * 1e-3 for i in range(9)] + uneven[0][1:]] * 3)
vtk("sliver.vtk", ([0.5, 0.500001] + even[0][1:], *even[1:]))
noise = [struct.unpack("f", struct.pack("f", 7000 + 0.1 * i))[0] for i in range(8)]
vtk("noise.vtk", (noise, *even[1:]), binary=True, of=lambda x, y, z: value(0.5 + round((x - 7000) * 10), y, z))

def lz4(data): # a block of literals, in which the first repetition of four bytes is a match
    def length(n):
        return b"" if n < 15 else bytes([255] * ((n - 15) // 255) + [(n - 15) % 255])
    def literals(n, match):
        return bytes([min(n, 15) << 4 | match]) + length(n)
    for at in range(4, len(data) - 16):
        before = data.find(data[at:at + 4], 0, at)
        if before >= 0:
            rest = data[at + 4:]
            return literals(at, 0) + data[:at] + struct.pack("<H", at - before) + literals(len(rest), 0) + rest
    return literals(len(data), 0) + data

def vtr(name, axes, how="ascii", cells=False, order="Little"):
    """how: ascii, binary (base64), raw, zlib, lz4 or lzma (appended), or packed (zlib in base64)."""
    middles = [[(a + b) / 2 for a, b in zip(x, x[1:])] for x in axes] if cells else axes
    values = [float(value(x, y, z)) for z in middles[2] for y in middles[1] for x in middles[0]]
    sign, appended = "<" if order == "Little" else ">", b""
    compress = how in ("zlib", "packed", "lz4", "lzma")
    def array(name, code, numbers):
        nonlocal appended
        data = struct.pack("%s%d%s" % (sign, len(numbers), code), *numbers)
        if compress:
            blocks = [data[i:i + 1000] for i in range(0, len(data), 1000)]
            packed = [{"lz4": lz4, "lzma": lambda b: lzma.compress(b, check=lzma.CHECK_CRC32)}.get(how, zlib.compress)(b) for b in blocks]
            head = struct.pack("%s%dI" % (sign, 3 + len(blocks)), len(blocks), 1000, len(data) % 1000, *map(len, packed))
            text = base64.b64encode(head) + base64.b64encode(b"".join(packed))
            data = head + b"".join(packed)
        else:
            data = struct.pack(sign + "I", len(data)) + data
            text = base64.b64encode(data)
        tag = '<DataArray type="Float%d" Name="%s" ' % (struct.calcsize(code) * 8, name)
        if how in ("raw", "zlib", "lz4", "lzma"):
            tag += 'format="appended" offset="%d"/>' % len(appended)
            appended += data
            return tag
        return tag + 'format="%s">%s</DataArray>' % (("ascii", " ".join(map(repr, numbers))) if how == "ascii" else ("binary", text.decode()))
    box = "3 %d 0 %d -2 %d" % (len(axes[0]) + 2, len(axes[1]) - 1, len(axes[2]) - 3)
    of = "Cell" if cells else "Point"
    data = ('<?xml version="1.0"?><VTKFile type="RectilinearGrid" version="0.1" byte_order="%sEndian"%s><RectilinearGrid WholeExtent="%s">'
            '<Piece Extent="%s"><%sData Scalars="v">%s</%sData><Coordinates>%s</Coordinates></Piece></RectilinearGrid>' % (
                order, ' compressor="vtk%sDataCompressor"' % {"lz4": "LZ4", "lzma": "LZMA"}.get(how, "ZLib") if compress else "", box, box, of, array("v", "f", values), of,
                "".join(array("c%d" % i, "d", x) for i, x in enumerate(axes)))).encode()
    if appended:
        data += b'<AppendedData encoding="raw">_' + appended + b"</AppendedData>"
    open("in/" + name, "wb").write(data + b"</VTKFile>")

for how in ("ascii", "binary", "raw", "zlib", "packed", "lz4", "lzma"):
    vtr("even_%s.vtr" % how, even, how)
    vtr("uneven_%s.vtr" % how, uneven, how, order="Big")
vtr("even_cells.vtr", even, "raw", cells=True)

def hdf5(name, axes, falling=False):
    order = [x[::-1] if falling else x for x in axes]
    with h5py.File("in/" + name, "w") as file:
        array = file.create_dataset("v", data=numpy.array([[[value(x, y, z) for x in order[0]] for y in order[1]] for z in order[2]], "f"))
        for i, (letter, x) in enumerate(zip("zyx", order[::-1])):
            scale = file.create_dataset(letter, data=numpy.array(x, "d") / 10)
            scale.attrs["units"] = "cm"
            scale.make_scale(letter)
            array.dims[i].attach_scale(scale)

try:
    import h5py, numpy
    hdf5("uneven.h5", uneven)
    hdf5("falling.h5", uneven, falling=True)
except ImportError:
    print("without h5py: coordinates in HDF5 are not checked")
P
same() { # REFERENCE FILE [OPTION..]
    isorender "in/$1" a.png --isovalue 50.5 --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json=a.json
    isorender "in/$2" b.png --isovalue 50.5 --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json=b.json "${@:3}"
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
expect(a["volume"]["dims"] == b["volume"]["dims"], sys.argv, a["volume"], b["volume"])
difference = max(abs(p - q) for row, other in zip(Png("a.png").rows, Png("b.png").rows) for s, t in zip(row, other) for p, q in zip(s, t))
expect(difference <= 1, sys.argv, difference)
expect(max(abs(p - q) for p, q in zip(a["bounds_world"], b["bounds_world"])) < 1e-4, sys.argv)' "$@"
}
for file in text binary double; do same even.nrrd $file.vtk; done
same cells.nrrd cells.vtk
same cells.nrrd even_cells.vtr
for how in ascii binary raw zlib packed lz4 lzma; do
    same even.nrrd even_$how.vtr
    same uneven.nrrd uneven_$how.vtr
done
cp in/even_raw.vtr in/no_extension
same even.nrrd no_extension
# a sliver of a cell does not make the volume a million times as large; the rounding of floats is no unevenness
isorender in/sliver.vtk --info 2>&1 | grep -q 'resampled from 9 x 11 x 5 voxels to the smallest or median step on each axis'
isorender in/sliver.vtk a.png --isovalue 50.5 --resolution 40x40 --quiet --json=a.json
python3 -c 'from check import *; expect(report("a.json")["volume"]["dims"] == [8, 11, 5], report("a.json")["volume"])'
! isorender in/noise.vtk --info 2>&1 | grep -q 'resampled' || false
for file in uneven uneven_binary; do same uneven.nrrd $file.vtk; done
for file in uneven falling; do if [ -f in/$file.h5 ]; then same uneven.nrrd $file.h5; fi; done
for threads in 1 3; do same uneven.nrrd uneven.vtk --threads $threads; done
isorender in/uneven.nrrd a.png --isovalue 50.5 --resolution 90x90 --chunk-size 16 --quiet
isorender in/uneven.vtk b.png --isovalue 50.5 --resolution 90x90 --chunk-size 16 --quiet
python3 -c 'from check import *
difference = max(abs(p - q) for row, other in zip(Png("a.png").rows, Png("b.png").rows) for s, t in zip(row, other) for p, q in zip(s, t))
expect(difference <= 1, difference)'
same uneven_cells.nrrd uneven_cells.vtk
isorender in/uneven.vtk --info 2>&1 | grep -q 'resampled from 7 x 11 x 7 voxels to the smallest step on each axis'
! isorender in/text.vtk --info 2>&1 | grep -q 'resampled' || false

isorender_refuses 3 'in/falling.vtk: its coordinates on axis 0 do not rise' in/falling.vtk
isorender_refuses 3 'in/vast.vtk: its steps on axis 0, from 1e-09 on, are too uneven' in/vast.vtk
isorender_refuses 5 'in/large.vtk: needs .* to read' in/large.vtk
for how in raw binary zlib ascii lz4 lzma; do
    head -c -700 in/even_$how.vtr >in/cut.vtr
    isorender_refuses 3 'in/cut.vtr: ' in/cut.vtr
done
sed 's/ZLib/Own/' in/even_zlib.vtr >in/own.vtr
isorender_refuses 3 'in/own.vtr: compressed by vtkOwnDataCompressor: zlib, LZ4 and LZMA are supported' in/own.vtr
sed 's/ZLib/LZ4/' in/even_zlib.vtr >in/wrong.vtr
isorender_refuses 3 'in/wrong.vtr: corrupt: a compressed block' in/wrong.vtr
sed 's/ZLib/LZMA/' in/even_zlib.vtr >in/wrong.vtr
isorender_refuses 3 'in/wrong.vtr: corrupt: a compressed block' in/wrong.vtr
ISO_MODULE_PATH=$PWD isorender_refuses 3 "in/even_lz4.vtr: the VTK reader (libisopoint-vti.so) is not installed: not in $PWD" in/even_lz4.vtr
sed 's/<Piece Extent="3 /<Piece Extent="4 /' in/even_raw.vtr >in/pieces.vtr
isorender_refuses 3 'in/pieces.vtr: is in several pieces: save it in one' in/pieces.vtr
sed 's/X_COORDINATES 8/X_COORDINATES 7/' in/text.vtk >in/few.vtk
isorender_refuses 3 'in/few.vtk: not a readable VTK file' in/few.vtk
sed 's/X_COORDINATES 8/X_COORDINATES 2000000000/' in/text.vtk >in/many.vtk
isorender_refuses 3 'in/many.vtk: truncated: the file ends in its coordinates' in/many.vtk
head -c 150 in/double.vtk >in/cut.vtk
isorender_refuses 3 'in/cut.vtk: truncated: the file ends in its coordinates' in/cut.vtk
printf '# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 0 float\n' >in/cells_of_any_kind.vtk
isorender_refuses 3 'in/cells_of_any_kind.vtk: holds a UNSTRUCTURED_GRID, not an image: python3 -c .import vtk; r = vtk.vtkGenericDataObjectReader()' in/cells_of_any_kind.vtk
printf '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid/></VTKFile>' >in/a.vtu
isorender_refuses 3 'in/a.vtu: holds a UnstructuredGrid, not an image: python3 -c .import vtk; r = vtk.vtkXMLGenericDataObjectReader()' in/a.vtu
printf 'CDF\2\0\0\0\1' >in/mesh.exo
printf 'CDF\1\0\0\0\1' >in/old.nc
echo '$MeshFormat' >in/mesh.msh
isorender_refuses 3 'in/mesh.exo: holds a grid of Exodus, not an image: python3 -c .import vtk; r = vtk.vtkExodusIIReader()' in/mesh.exo
isorender_refuses 3 'in/mesh.msh: holds a grid of Gmsh, not an image: meshio convert' in/mesh.msh
isorender_refuses 3 'in/old.nc: is NetCDF of version 3: nccopy -k netCDF-4' in/old.nc
