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
refuse 3 'in/four.gii: not a readable GIFTI surface: its points or triangles are not rows of three numbers' in/four.gii
