# Concave polygons are not drawn as fans; rows of ASCII .ply may be longer than declared, or hold several items.
python3 - <<'P'
from check import *
# the letter C, seen from above: 76 of 100; lying, as one polygon of .obj, .ply
corners = [(0, 0), (10, 0), (10, 3), (4, 3), (4, 7), (10, 7), (10, 10), (0, 10)]
with open("in/c.obj", "w") as file:
    file.write("\ufeff# C:\\not continued\\\n" + "".join("v %d %d 0\n" % c for c in corners))
    file.write("f 1 2 3 4 \\\n  5 6 7 8\n")
with open("in/c.off", "w") as file:
    file.write("OFF # C\n# between\n8 1 8\n" + "".join("%d %d 0\n" % c for c in corners) + "8 0 1 2 3 4 5 6 7 255 0 0\n")
header = "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n" \
         "element face %d\nproperty list uchar int vertex_index\nend_header\n"
with open("in/c.ply", "w") as file:
    file.write(header % (8, 1) + "".join("%d\n%d 0\n" % c for c in corners)) # a vertex over two rows
    file.write("8 0 1 2 3 4 5 6 7 9 1 1 1 1 1 1\n")
with open("in/square.ply", "w") as file:
    file.write(header % (4, 2) + "0 0 0 10 0 0\n10 10 0 0 10 0 3 0 1 2\n3 0 2 3\n")
points = " ".join("%d %d 0" % c for c in corners)
with open("in/c.vtk", "w") as file:
    file.write("# vtk DataFile Version 3.0\nC\nASCII\nDATASET POLYDATA\nPOINTS 8 float\n" + points)
    file.write("\nPOLYGONS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_DATA 1\nSCALARS a float\nLOOKUP_TABLE default\n3\n")
array = '<DataArray type="%s" Name="%s" NumberOfComponents="%d" format="ascii">%s</DataArray>\n'
with open("in/c.vtp", "w") as file: # the left half is a strip, the rest two polygons
    file.write('<VTKFile type="PolyData"><PolyData>\n<Piece NumberOfPoints="10" NumberOfPolys="2" NumberOfStrips="1">\n')
    file.write("<Points>" + array % ("Float32", "p", 3, points + " 4 0 0 4 10 0") + "</Points>\n")
    file.write("<Strips>" + array % ("Int64", "connectivity", 1, "0 8 7 9") + array % ("Int64", "offsets", 1, "4"))
    file.write("</Strips>\n<Polys>" + array % ("Int64", "connectivity", 1, "8 1 2 3 4 5 6 9"))
    file.write(array % ("Int64", "offsets", 1, "4 8") + "</Polys>\n</Piece></PolyData></VTKFile>\n")
P
for file in c.obj c.ply c.off c.vtk c.vtp square.ply; do
    isorender --surface in/$file $file.png --camera top --orthographic --resolution 100x100 --background none --quiet
done
python3 - <<'P'
from check import *
def covered(name):
    return sum(pixel[3] > 127 for row in Png(name).rows for pixel in row)
square = covered("square.ply.png")
for name in ("c.obj.png", "c.ply.png", "c.off.png", "c.vtk.png", "c.vtp.png"):
    expect(abs(covered(name) / square - .76) < .02, name, covered(name), square)
P
# A .off with faces is a mesh when it is the input, too; with colours at its vertices, or without faces, it is points.
isorender in/c.off off.png --camera top --orthographic --resolution 100x100 --background none 2>said
grep -q 'c.off: note: drawn as the mesh of its faces (--method splats: its vertices as points)' said
isocompare images c.off.png off.png --fail-under psnr=99 >/dev/null
sed 's/^OFF/COFF/; s/^[0-9]* [0-9]* 0$/& 9 9 9 255/' in/c.off >in/painted.off
isorender in/painted.off painted.png --resolution 50x50 2>said
grep -q 'painted.off: note: drawn as points: its faces are not drawn (--surface draws them)' said
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 0 1\n' >in/none.off
isorender in/none.off none.png --resolution 50x50 2>said
! grep -q note said
head -n 11 in/c.off >in/cut.off
refuses 3 'in/cut.off: truncated: faces are missing' isorender in/cut.off bad.png
