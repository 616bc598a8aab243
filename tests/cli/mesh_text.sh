# Text of meshes with byte order marks, capitals, other encodings, rubbish behind numbers, or cut.
python3 - <<'P'
facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 %s\nendloop\nendfacet\n"
solid = "solid a\n" + facet % 0 + facet % 5 + "endsolid a\n"
open("in/mark.stl", "w").write("\ufeff" + solid)
open("in/capitals.stl", "w").write(solid.upper())
open("in/blank.stl", "w").write("\n  " + solid)
open("in/wide.stl", "w", encoding="utf-16").write(solid)
open("in/wide.obj", "w", encoding="utf-16").write("v 0 0 0\n")
open("in/number.stl", "w").write(solid.replace("vertex 9 0 0", "vertex 9 0 0x"))
open("in/number.obj", "w").write("v 0 0 0\nv 1 0 3.1+e2\nv 0 1 0\nf 1 2 3\n")
open("in/cut.stl", "w").write(solid[:solid.index("endsolid")])
open("in/early.stl", "w").write(solid[:30])
open("in/cut.obj", "w").write("f 1 2 3\nv 0 0 0\nv 1 0 3\n")
header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
         "element face 1\nproperty list uchar int vertex_index\nend_header\n"
body = "0 0 0\n9 0 0\n0 9 0\n3 0 1 2\n"
open("in/mark.ply", "w").write("\ufeff" + header + body)
open("in/mark_body.ply", "w").write(header + "\ufeff" + body)
open("in/short.ply", "w").write(header.replace("vertex 3", "vertex 4").replace("face 1", "face 3") + "0 0 0\n9 0\n0 9 0\n0 0 9\n" +
                                "3 0 1 2\n3 0 1 3\n3 1 2 3\n")
open("in/one_row.ply", "w").write(header + body.replace("\n", " "))
open("in/none.obj", "w").write("v 0 0 0\nv 1 2 3\nv -1 -2 -3\nf 1 2 3\n")
P
for file in mark.stl capitals.stl blank.stl mark.ply mark_body.ply; do
    isorender --surface in/$file $file.png --quiet
done
python3 - <<'P'
from check import *
pictures = [Png(name + ".png").rows for name in ("mark.stl", "capitals.stl", "blank.stl", "mark.ply", "mark_body.ply")]
expect(pictures[0] == pictures[1] == pictures[2] and pictures[3] == pictures[4], "other pictures")
P
isorender_refuses 3 "wide.stl: text in UTF-16" --surface in/wide.stl
isorender_refuses 3 "wide.obj: text in UTF-16" --surface in/wide.obj
isorender_refuses 3 "facet 1 is not a triangle" --surface in/number.stl
isorender_refuses 3 "line 2: not a vertex" --surface in/number.obj
isorender_refuses 3 "cut.stl: truncated" --surface in/cut.stl
isorender_refuses 3 "early.stl: truncated: it has no endsolid" --surface in/early.stl
isorender_refuses 3 "short.ply: damaged: a row has fewer numbers" --surface in/short.ply
isorender --surface in/one_row.ply one_row.png --quiet
isorender_refuses 3 "names vertex 2 of 2" --surface in/cut.obj
isorender_refuses 6 "none.obj: nothing to draw: no triangle has an area" --surface in/none.obj
rm -f said
