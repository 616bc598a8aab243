# Amira's lattices (text, both byte orders, zlib, runs of bytes) and XDMF's grids (values in the text, in raw and HDF5 files;
# uniform and rectilinear; times of a collection) give the pictures of the .nrrd of the same voxels.
python3 - <<'P'
from check import *
dims = (12, 9, 7)
value = lambda x, y, z: 100 - 3 * (x - 5) ** 2 - 2 * (y - 4) ** 2 - 4 * (z - 3) ** 2
voxels = [value(x, y, z) for z in range(7) for y in range(9) for x in range(12)]
labels = [int(v > 50) for v in voxels]
steps, origin = (0.5, 1, 1.5), (1, 2, 3)

def nrrd(name, code, kind, values, unit=1):
    head = "NRRD0004\ntype: %s\ndimension: 3\nsizes: 12 9 7\nencoding: raw\nendian: little\nspace: 3D-right-handed\n" % kind
    head += "space directions: (%r,0,0) (0,%r,0) (0,0,%r)\nspace origin: (%r,%r,%r)\n\n" % tuple(unit * v for v in (*steps, *origin))
    open("in/" + name, "wb").write(head.encode() + struct.pack("<%d%s" % (len(values), code), *values))

nrrd("v.nrrd", "f", "float", voxels)
nrrd("l.nrrd", "B", "uint8", labels)
nrrd("um.nrrd", "f", "float", voxels, 1e-3)

def runs(data): # equal bytes, and bytes as they are
    out, at = b"", 0
    while at < len(data):
        n = 1
        while at + n < len(data) and data[at + n] == data[at] and n < 127:
            n += 1
        if n == 1:
            n = min(3, len(data) - at)
            out += bytes((128 | n,)) + data[at:at + n]
        else:
            out += bytes((n, data[at]))
        at += n
    return out

def amira(name, first, labels_data, data, packed=("", ""), unit="", kind="uniform"):
    head = "# %s\n\n\ndefine Lattice 12 9 7\n\nParameters {\n    Units {\n        Coordinates \"%s\"\n    }\n    Content \"12x9x7 float, uniform coordinates\",\n" \
           "    BoundingBox 1 6.5 2 10 3 12,\n    CoordType \"%s\"\n}\n\nLattice { byte Labels } @1%s\nLattice { float Data } @2%s\n\n# Data section follows\n" % (
               first, unit, kind, *packed)
    open("in/" + name, "wb").write(head.encode() + b"@1\n" + labels_data + b"\n\n@2\n" + data + b"\n")

floats = struct.pack("<%df" % len(voxels), *voxels)
zipped, run = zlib.compress(floats), runs(bytes(labels))
text = lambda values: " ".join(map(str, values)).encode()
amira("text.am", "AmiraMesh 3D ASCII 2.0", text(labels), text(voxels))
amira("little.am", "AmiraMesh BINARY-LITTLE-ENDIAN 2.1", bytes(labels), floats)
amira("big.am", "AmiraMesh 3D BINARY 2.0", bytes(labels), struct.pack(">%df" % len(voxels), *voxels))
amira("packed.am", "Avizo BINARY-LITTLE-ENDIAN 2.1", run, zipped, ("(HxByteRLE,%d)" % len(run), "(HxZip,%d)" % len(zipped)))
amira("um.am", "Avizo BINARY-LITTLE-ENDIAN 2.1", bytes(labels), floats, unit="um")
amira("curved.am", "AmiraMesh BINARY-LITTLE-ENDIAN 2.1", bytes(labels), floats, kind="curvilinear")
amira("other.am", "AmiraMesh BINARY-LITTLE-ENDIAN 2.1", bytes(labels), floats, ("", "(HxOther,12)"))

def item(values, sizes, more=""):
    return '<DataItem Dimensions="%s" NumberType="Float" Precision="4" %s>%s</DataItem>' % (sizes, more or 'Format="XML"', values)

numbers = lambda values: " ".join(map(repr, values))
even = ('TopologyType="3DCoRectMesh"', "ORIGIN_DXDYDZ", item("3 2 1", 3) + item("1.5 1 0.5", 3))
axes = [[o + s * i for i in range(n)] for o, s, n in zip(origin, steps, dims)]
lists = ('TopologyType="3DRectMesh"', "VXVYVZ", "".join(item(numbers(a), len(a)) for a in axes))

def grid(data, shape=even, center="Node"):
    return '<Grid Name="g" GridType="Uniform"><Topology %s Dimensions="7 9 12"/><Geometry GeometryType="%s">%s</Geometry><Attribute Name="v" ' \
           'AttributeType="Scalar" Center="%s">%s</Attribute></Grid>' % (*shape, center, data)

def xdmf(name, inside):
    open("in/" + name, "w").write('<?xml version="1.0" ?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n<Xdmf Version="3.0"><Domain>%s</Domain></Xdmf>\n' % inside)

open("in/little.bin", "wb").write(b"four" + floats)
open("in/big.bin", "wb").write(struct.pack(">%df" % len(voxels), *voxels))
open("in/zlib.bin", "wb").write(b"four" + zipped)
raw = item("big.bin", "7 9 12", 'Format="Binary" Endian="Big"')
xdmf("text.xdmf", grid(item(numbers(voxels), "7 9 12")))
xdmf("raw.xmf", grid(item(" little.bin\n", "7 9 12", 'Format="Binary" Endian="Little" Seek="4"')))
xdmf("big.xdmf", grid(raw))
xdmf("zlib.xdmf", grid(item("zlib.bin", "7 9 12", 'Format="Binary" Compression="Zlib" Seek="4"')))
xdmf("lists.xdmf", grid(raw, lists))
low = item(numbers([v - 500 for v in voxels]), "7 9 12")
xdmf("times.xdmf", '<Grid GridType="Collection" CollectionType="Temporal">%s</Grid>' % (grid(low) + grid(raw)))
xdmf("cloud.xdmf", grid(raw, ('TopologyType="Polyvertex"', even[1], even[2])))
xdmf("slab.xdmf", grid(item(item("1 2", 2) + raw, "7 9 12", 'ItemType="HyperSlab"')))
xdmf("few.xdmf", grid(item("big.bin", "7 9 11", 'Format="Binary" Endian="Big"')))
xdmf("lost.xdmf", grid(item("lost.bin", "7 9 12", 'Format="Binary"')))
xdmf("lost5.xdmf", grid(item("lost.h5:/v", "7 9 12", 'Format="HDF"')))
xdmf("whole.xdmf", grid(item("v.h5:/v", "7 9 12", 'Format="HDF"')))
open("in/cut.xdmf", "w").write(open("in/big.xdmf").read()[:-12])
try:
    import h5py, numpy
    with h5py.File("in/v.h5", "w") as file:
        file["v"] = numpy.array(voxels, "f4").reshape(7, 9, 12)
        for i, n in enumerate((7, 9, 12)): # scales whose steps are not even, which XDMF's geometry replaces
            scale = file.create_dataset("s%d" % i, data=numpy.arange(n) ** 2.0)
            scale.make_scale()
            file["v"].dims[i].attach_scale(scale)
        for letter, axis in zip("xyz", axes):
            file["at/" + letter] = numpy.array(axis)
    far = [item("v.h5:/at/" + letter, n, 'Format="HDF"') for letter, n in zip("xyz", dims)]
    whole = item("v.h5:/v", "7 9 12", 'Format="HDF"')
    xdmf("placed.xdmf", grid(whole, (lists[0], lists[1], "".join(far))))
    xdmf("short.xdmf", grid(whole, (lists[0], lists[1], "".join([far[0].replace("/x", "/y"), *far[1:]]))))
except ImportError:
    print("without h5py: XDMF with HDF5 is not checked")
P
same() { # ISOVALUE REFERENCE FILE [OPTION..]
    isorender "in/$2" a.png --isovalue "$1" --resolution 80x80 --quiet --json=a.json
    isorender "in/$3" b.png --isovalue "$1" --resolution 80x80 --quiet --json=b.json "${@:4}"
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
expect(a["image"]["hash"] == b["image"]["hash"], sys.argv)
expect(max(abs(p - q) for p, q in zip(a["bounds_world"], b["bounds_world"])) < 1e-6, sys.argv)' "$@"
}
for file in text little big packed; do
    same 50.5 v.nrrd $file.am --grid Data
    same 0.5 l.nrrd $file.am --grid Labels
done
same 50.5 um.nrrd um.am --grid Data
for file in text.xdmf raw.xmf big.xdmf zlib.xdmf lists.xdmf; do same 50.5 v.nrrd $file; done
same 50.5 v.nrrd times.xdmf --component 1
if [ -e in/v.h5 ]; then
    for file in whole placed; do same 50.5 v.nrrd $file.xdmf; done
    isorender_refuses 3 'in/v.h5: /at/y is not an array of 12 numbers' in/short.xdmf
fi
isorender in/times.xdmf --info 2>&1 | grep -q 'note: several grids: using component 0 of 2'
cp in/little.am in/no_extension
same 50.5 v.nrrd no_extension --grid Data
isorender_refuses 3 'in/curved.am: its coordinates are not uniform' in/curved.am
isorender_refuses 3 'in/other.am: packed by HxOther, which is not read' in/other.am
isorender_refuses 2 "in/little.am: no array 'none', there are 'Labels', 'Data'" in/little.am --grid none
for file in little packed text; do
    head -c -300 in/$file.am >in/cut.am
    isorender_refuses 3 'in/cut.am: .*' in/cut.am --grid Data
done
isorender_refuses 3 'in/cloud.xdmf: holds a grid of Polyvertex, not an image' in/cloud.xdmf
isorender_refuses 3 "in/slab.xdmf: the values of 'v' are a selection or function of others" in/slab.xdmf
isorender_refuses 3 "in/few.xdmf: array 'v' has 693 values for 756 voxels" in/few.xdmf
isorender_refuses 3 'in/lost.xdmf: in/lost.bin: ' in/lost.xdmf
isorender_refuses 3 'in/lost5.xdmf: in/lost.h5:/v: cannot read' in/lost5.xdmf
isorender_refuses 3 'in/cut.xdmf: truncated: it does not end with </Xdmf>' in/cut.xdmf
