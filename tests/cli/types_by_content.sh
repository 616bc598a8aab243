# What a file's first bytes tell counts without an extension, for every program; what only names tell, by every name of the type.
python3 - <<'T'
import struct
head = "mrtrix tracks\ndatatype: Float32LE\ncount: 1\nfile: . 80\nEND\n"
nan, inf = float("nan"), float("inf")
with open("in/tracts", "wb") as out:
    out.write(head.encode().ljust(80, b"\0"))
    out.write(struct.pack("<12f", 0, 0, 0, 10, 0, 5, nan, nan, nan, inf, inf, inf))
corners = [(x, y, z) for z in (0, 8) for y in (0, 8) for x in (0, 8)]
faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
rows = ["%d %d %d" % c for c in corners] + ["4 %d %d %d %d" % f for f in faces]
ply = ["ply", "format ascii 1.0", "element vertex 8"] + ["property float " + axis for axis in "xyz"]
ply += ["element face 6", "property list uchar int vertex_indices", "end_header"]
open("in/cube", "w").write("\n".join(ply + rows) + "\n")
open("in/cube.off", "w").write("\n".join(["OFF", "8 6 0"] + rows) + "\n")
vtk = ["# vtk DataFile Version 3.0", "cube", "ASCII", "DATASET POLYDATA", "POINTS 8 float"] + rows[:8]
open("in/polygons", "w").write("\n".join(vtk + ["POLYGONS 6 30"] + rows[8:]) + "\n")
open("in/points.pcd", "w").write("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\n"
                                 "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
T
cp in/points.pcd in/scan

# isorender draws each as the same file with a name.
for pair in tracts:tck cube:ply polygons:vtk scan:pcd; do
    name=${pair%:*} extension=${pair#*:}
    cp "in/$name" "in/named.$extension"
    isorender "in/$name" a.png --quiet --resolution 64x64 && isorender "in/named.$extension" b.png --quiet --resolution 64x64 || exit 1
    python3 -c 'from check import Png; assert Png("a.png").pixels() == Png("b.png").pixels()' ||
        { echo "$name is not drawn as .$extension"; exit 1; }
done
# Points come through a pipe in every format that tells itself.
isorender - c.png --quiet --resolution 64x64 <in/scan || exit 1
# isosculpt begins with the same meshes, by content and by name.
for name in cube cube.off polygons; do
    isosculpt --headless --open "in/$name" --voxel-size 0.5 --mesh "$name.stl" --quiet || exit 1
done
cmp cube.stl cube.off.stl && cmp cube.stl polygons.stl
