# Surfaces of neuroimaging, GIFTI in every encoding and FreeSurfer's, give the picture of the same mesh in PLY, in LPS.
python3 - <<'P'
import base64
import struct
import zlib
from check import *
points = [(10, 0, 1), (-12, 0, 0), (0, 9, 0), (0, -8, 2), (1, 0, 11), (0, 1, -13)]
faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
flat = lambda rows: [v for r in rows for v in r]

def ply(name, moved):
    rows = ["%r %r %r" % (-x, -y, z) for x, y, z in moved] + ["3 %d %d %d" % f for f in faces]
    head = "ply\nformat ascii 1.0\nelement vertex 6\n" + "".join("property float %s\n" % a for a in "xyz")
    open("in/" + name, "w").write(head + "element face 8\nproperty list uchar int vertex_indices\nend_header\n" + "\n".join(rows) + "\n")

def array(intent, kind, code, rows, how, big=False, columns=False, lines=False):
    order = [r[i] for i in range(3) for r in rows] if columns else flat(rows)
    data = struct.pack("%s%d%s" % (">" if big else "<", len(order), code), *order)
    text = " ".join(map(repr, flat(rows))) if how == "ASCII" else \
        (base64.encodebytes if lines else base64.b64encode)(zlib.compress(data) if how.startswith("G") else data).decode()
    return ('<DataArray Intent="NIFTI_INTENT_%s" DataType="NIFTI_TYPE_%s" ArrayIndexingOrder="%sMajorOrder" Dimensionality="2" '
            'Dim0="%d" Dim1="3" Encoding="%s" Endian="%sEndian" ExternalFileName="" ExternalFileOffset="">\n<MetaData/>\n'
            "<Data>%s</Data>\n</DataArray>\n" % (intent, kind, "Column" if columns else "Row", len(rows), how, "Big" if big else "Little", text))

def gii(name, how, code="f", kind="FLOAT32", **more):
    open("in/" + name, "w").write('<?xml version="1.0" encoding="UTF-8"?>\n<!DOCTYPE GIFTI SYSTEM "gifti.dtd">\n<!-- a > b -->\n'
                                  '<GIFTI Version="1.0" NumberOfDataArrays="2">\n' + array("POINTSET", kind, code, points, how, **more)
                                  + array("TRIANGLE", "INT32", "i", faces, how, **more) + "</GIFTI>\n")

def freesurfer(name, footer=b"", mark=b"\xff\xff\xfe"):
    data = mark + b"created by hand\n\n" + struct.pack(">2i18f24i", 6, 8, *flat(points), *flat(faces))
    open("in/" + name, "wb").write(data + footer)

ply("plain.ply", points)
gii("text.surf.gii", "ASCII")
gii("base64.gii", "Base64Binary")
gii("lines.gii", "Base64Binary", lines=True)
gii("zlib.gii", "GZipBase64Binary")
gii("big.gii", "GZipBase64Binary", "d", "FLOAT64", big=True)
gii("columns.gii", "Base64Binary", columns=True)
gii("outside.gii", "ExternalFileBinary")
freesurfer("lh.white")
right, down, front, middle = (-0.8, 0.6, 0), (0, 0, -1), (0.6, 0.8, 0), (5, -17, 18)
place = "valid = 1  # volume info valid\nfilename = ../mri/T1.mgz\nvolume = 256 256 256\nvoxelsize = 1 1 1\n"
place += "".join("%s   = %r %r %r\n" % (n, *v) for n, v in (("xras", right), ("yras", down), ("zras", front), ("cras", middle)))
freesurfer("lh.pial", struct.pack(">3i", 2, 0, 20) + place.encode())
freesurfer("short_footer", struct.pack(">i", 20) + place.encode())
freesurfer("invalid.pial", struct.pack(">i", 20) + place.replace("valid = 1", "valid = 0", 1).encode())
freesurfer("scanner.pial", struct.pack(">3i", 2, 1, 20) + place.encode())
# as the volume of that place has it: voxel of the surface's coordinates, then its matrix
ply("moved.ply", [tuple(middle[i] - x * right[i] + y * front[i] - z * down[i] for i in range(3)) for x, y, z in points])
freesurfer("lh.curv", mark=b"\xff\xff\xff")
P
draw() { # FILE
    isorender --surface "in/$1" "$1.png" --resolution 90x90 --azimuth 30 --elevation 20 --quiet --json="$1.json"
}
same() { # REFERENCE FILE..
    draw "$1"
    for file in "${@:2}"; do
        draw "$file"
        python3 -c 'from check import *
a, b = report(sys.argv[1]), report(sys.argv[2])
expect(a["image"]["hash"] == b["image"]["hash"], sys.argv)
expect(max(abs(p - q) for p, q in zip(a["bounds_world"], b["bounds_world"])) < 1e-5, sys.argv)' "$1.json" "$file.json"
    done
}
same plain.ply text.surf.gii base64.gii lines.gii zlib.gii big.gii columns.gii lh.white invalid.pial scanner.pial
same moved.ply lh.pial short_footer
if python3 -c 'import nibabel' 2>/dev/null; then
    python3 -c 'from check import *
import nibabel
for name in ("in/zlib.gii", "in/big.gii", "in/base64.gii"):
    points, faces = (a.data for a in nibabel.load(name).darrays)
    expect(points.shape == (6, 3) and faces.shape == (8, 3) and points.max() == 11 and points.min() == -13, name)
expect(abs(nibabel.freesurfer.read_geometry("in/lh.pial")[0].min() + 13) < 1e-6, "pial")'
fi

refuse() { isorender_refuses "$1" "$2" --surface "$3"; } # STATUS TEXT FILE
refuse 3 'in/lh.curv: ' in/lh.curv
refuse 3 'in/outside.gii: values in the encoding ExternalFileBinary are not read (wb_command -gifti-convert)' in/outside.gii
for file in zlib.gii base64.gii text.surf.gii; do
    head -c 700 in/$file >in/cut_$file
    refuse 3 "in/cut_$file: truncated" in/cut_$file
done
head -c 60 in/lh.white >in/cut.white
refuse 3 'in/cut.white: truncated' in/cut.white
sed 's/NIFTI_INTENT_POINTSET/NIFTI_INTENT_SHAPE/' in/zlib.gii >in/shape.gii
refuse 3 'in/shape.gii: holds no surface' in/shape.gii
sed 's/Dim0="6"/Dim0="4000000000"/' in/base64.gii >in/many.gii
refuse 3 'in/many.gii: truncated: an array has fewer bytes than it states' in/many.gii
sed 's/Dim0="6"/Dim0="60"/' in/zlib.gii >in/more.gii
refuse 3 'in/more.gii: corrupt: a compressed array' in/more.gii
sed 's/Dim1="3"/Dim1="4"/' in/zlib.gii >in/four.gii
refuse 3 'in/four.gii: not a readable GIFTI file: its points or triangles are not rows of three numbers' in/four.gii

# Numbers of vertices colour the mesh as a volume does in which they are the same: a linear one, exact between vertices and voxels.
python3 - <<'P'
import base64
import struct
import zlib
from check import *
points = [(-x, -y, z) for x, y, z in [(10, 0, 1), (-12, 0, 0), (0, 9, 0), (0, -8, 2), (1, 0, 11), (0, 1, -13)]]  # in LPS
numbers = [2 * x + 3 * y - z for x, y, z in points]
voxels = [2 * x + 3 * y - z for z in range(-14, 15) for y in range(-14, 15) for x in range(-14, 15)]
open("in/linear.nrrd", "wb").write(b"NRRD0004\ntype: float\ndimension: 3\nsizes: 29 29 29\nspace: left-posterior-superior\nendian: little\n"
                                   b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-14,-14,-14)\nencoding: raw\n\n"
                                   + struct.pack("<%df" % len(voxels), *voxels))
open("in/rh.curv", "wb").write(b"\xff\xff\xff" + struct.pack(">3i6f", 6, 8, 1, *numbers))
labels = [(250, 20, 30), (20, 240, 30), (10, 20, 230)]
pairs = [(v, sum(c << 8 * k for k, c in enumerate(labels[v % 3]))) for v in range(5)]  # (the sixth has none)
annot = struct.pack(">i", 6) + b"".join(struct.pack(">2i", *p) for p in pairs + [(5, 0)]) + struct.pack(">i", 0)
open("in/lh.aparc.annot", "wb").write(annot)

def data(kind, code, values, intent, how="GZipBase64Binary", name=None, dims='Dimensionality="1" Dim0="%d"' % len(numbers)):
    packed = struct.pack("<%d%s" % (len(values), code), *values)
    text = " ".join(map(repr, values)) if how == "ASCII" else base64.b64encode(zlib.compress(packed) if how[0] == "G" else packed).decode()
    named = "<MD><Name><![CDATA[Name]]></Name><Value><![CDATA[%s]]></Value></MD>" % name if name else ""
    return ('<DataArray Intent="NIFTI_INTENT_%s" DataType="NIFTI_TYPE_%s" ArrayIndexingOrder="RowMajorOrder" %s Encoding="%s" '
            'Endian="LittleEndian"><MetaData>%s</MetaData><Data>%s</Data></DataArray>\n' % (intent, kind, dims, how, named, text))

def gii(name, *arrays, table=""):
    open("in/" + name, "w").write('<?xml version="1.0"?>\n<GIFTI Version="1.0">\n%s%s</GIFTI>\n' % (table, "".join(arrays)))

zeros = data("FLOAT32", "f", [0.0] * 6, "TIME_SERIES", name="zeros")
gii("a.func.gii", data("FLOAT32", "f", numbers, "SHAPE"))
gii("b.func.gii", zeros, data("FLOAT64", "d", [float(v) for v in numbers], "NONE", "ASCII", "linear map"))
gii("two.func.gii", data("FLOAT32", "f", numbers * 2, "SHAPE", dims='Dimensionality="2" Dim0="6" Dim1="2"'))
table = "<LabelTable>" + "".join('<Label Key="%d" Red="%r" Green="%r" Blue="%r" Alpha="1">x</Label>' % (key, *(c / 255 for c in color))
                                 for key, color in zip((5, 2, 9), labels)) + "</LabelTable>"
gii("a.label.gii", data("INT32", "i", [5, 2, 9, 5, 2, 77], "LABEL"), table=table)
open("in/five.curv", "wb").write(b"\xff\xff\xff" + struct.pack(">3i5f", 5, 8, 1, *numbers[:5]))
open("in/old.curv", "wb").write(b"\0\0\6" + bytes(30))
open("in/wide.annot", "wb").write(struct.pack(">i", 6) + struct.pack(">12i", *([7, 1] * 6)))
open("in/below.annot", "wb").write(struct.pack(">i", 6) + struct.pack(">12i", *([-1, 1] * 6)))
P
color() { # OUTPUT WHAT..
    isorender --surface in/lh.white --surface-color-by "$2" -o "$1.png" --resolution 90x90 --azimuth 30 --elevation 20 --json="$1.json" "${@:3}" >"$1.log" 2>&1
}
color volume in/linear.nrrd --range -40,40
color curv in/rh.curv --range -40,40
color annot in/lh.aparc.annot
color a.label.gii in/a.label.gii
for name in a.func.gii b.func.gii:1 'b.func.gii:linear map'; do color "$name" "in/$name" --range -40,40; done
python3 -c 'from check import *
def pixels(name): return list(Png(name + ".png").pixels())
same = lambda a, b, most: max(abs(p - q) for x, y in zip(pixels(a), pixels(b)) for p, q in zip(x, y)) <= most
expect(same("volume", "curv", 2), "as the volume")
for name in ("a.func.gii", "b.func.gii:1", "b.func.gii:linear map"): expect(pixels(name) == pixels("curv"), name)
expect(pixels("a.label.gii") == pixels("annot") != pixels("curv"), "labels")
colors = report("curv.json")["surface_colors"][0]
expect(colors["by"] == "vertices" and colors["range"] == [-40, 40] and "range" not in report("annot.json")["surface_colors"][0], colors)'
if python3 -c 'import nibabel' 2>/dev/null; then
    python3 -c 'from check import *
import nibabel
labels, table, names = nibabel.freesurfer.read_morph_data("in/rh.curv"), nibabel.load("in/a.label.gii"), nibabel.load("in/b.func.gii")
expect(list(labels) == [-21, 24, -27, 22, -13, 10] and len(table.darrays[0].data) == 6 and list(names.darrays[1].data) == list(labels), labels)'
fi
refuse_values() { isorender_refuses "$1" "$2" --surface in/lh.white --surface-color-by "$3"; } # STATUS TEXT FILE
refuse_values 3 'in/five.curv: has numbers of 5 vertices: in/lh.white has 6' in/five.curv
refuse_values 3 "in/old.curv: not FreeSurfer's numbers of vertices" in/old.curv
refuse_values 3 'in/wide.annot: not an annotation of FreeSurfer: label 1 of vertex 7' in/wide.annot
refuse_values 3 'in/below.annot: not an annotation of FreeSurfer: label 1 of vertex -1' in/below.annot
refuse_values 2 'in/b.func.gii: there is no array 2: it has 2 (0 ..)' in/b.func.gii:2
refuse_values 2 'in/rh.curv: there is no array 1' in/rh.curv:1
refuse_values 3 'in/two.func.gii: not a readable GIFTI file: its data are not one number of each vertex' in/two.func.gii
refuse_values 3 'in/zlib.gii: holds no data of vertices' in/zlib.gii
for file in rh.curv lh.aparc.annot a.func.gii; do
    head -c 30 "in/$file" >"in/cut.${file##*.}"
    refuse_values 3 "in/cut.${file##*.}: " "in/cut.${file##*.}"
done
isorender_refuses 2 'it has no vertices, as a mesh of --surface has' scene:sphere:16 --surface-color-by in/rh.curv
