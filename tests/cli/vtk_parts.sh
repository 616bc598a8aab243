# VTK's files that name others: pieces of .pvti with ghost points are put together, the times of .pvd are components, and a block
# of .vtm is read, by its name if one is given. All give the picture of the whole.
python3 - <<'P'
import os
from check import *
value = lambda x, y, z: 100 - 3 * (x - 5) ** 2 - 2 * (y - 4) ** 2 - 4 * (z - 3) ** 2
place = 'Origin="1 2 3" Spacing="0.5 1 1.5"'
words = lambda numbers: " ".join(map(str, numbers))
os.mkdir("in/d")

def vti(name, box, of=value, kind="Point"):
    x, y, z = (range(box[i], box[i + 1] + (kind == "Point")) for i in (0, 2, 4))
    numbers = words(of(i, j, k) for k in z for j in y for i in x)
    open("in/" + name, "w").write(
        '<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian"><ImageData WholeExtent="%s" %s><Piece Extent="%s"><%sData Scalars="v">'
        '<DataArray type="Float32" Name="v" format="ascii">%s\n</DataArray></%sData></Piece></ImageData></VTKFile>' % (
            words(box), place, words(box), kind, numbers, kind))

def pvti(name, pieces, data="Point", kind="Float32"):
    open("in/" + name, "w").write(
        '<VTKFile type="PImageData" version="0.1"><PImageData WholeExtent="0 11 0 8 0 6" GhostLevel="1" %s><P%sData Scalars="v">'
        '<PDataArray type="%s" Name="v"/></P%sData>%s</PImageData></VTKFile>' % (place, data, kind, data, "".join(
            '<Piece Extent="%s" Source="%s"/>' % (words(box), file) for box, file in pieces)))

whole = (0, 11, 0, 8, 0, 6)
boxes = [(x, min(x + 6, 11), y, min(y + 5, 8), 0, 6) for x in (0, 5) for y in (0, 4)]
vti("whole.vti", whole)
vti("later.vti", whole, lambda x, y, z: value(x, y, z) + 20)
vti("cells.vti", whole, kind="Cell")
for i, box in enumerate(boxes):
    vti("d/p%d.vti" % i, box)
    vti("d/c%d.vti" % i, box, kind="Cell")
pieces = [(box, "d/p%d.vti" % i) for i, box in enumerate(boxes)]
pvti("p.pvti", pieces)
pvti("c.pvti", [(box, "d/c%d.vti" % i) for i, box in enumerate(boxes)], "Cell")
pvti("few.pvti", pieces[1:])
pvti("outside.pvti", [((0, 12, 0, 8, 0, 6), "whole.vti")])
pvti("other.pvti", [(boxes[0], "d/p1.vti"), *pieces[1:]])
pvti("kind.pvti", pieces, kind="UInt8")
pvti("lost.pvti", [(boxes[0], "d/lost.vti"), *pieces[1:]])
pvti("itself.pvti", [(whole, "itself.pvti")])

def collection(name, *files):
    open("in/" + name, "w").write('<VTKFile type="Collection" version="0.1"><Collection>%s</Collection></VTKFile>' % "".join(
        '<DataSet timestep="%g" part="%d" file="%s"/>' % row for row in files))

collection("t.pvd", (0, 0, "p.pvti"), (0, 1, "later.vti"), (0.5, 0, "later.vti"), (1.5, 0, "b.vtm"))
collection("itself.pvd", (0, 0, "itself.pvd"))
collection("mesh.pvd", (0, 0, "mesh.stl"))
open("in/mesh.stl", "w").write("solid\nendsolid\n")
open("in/b.vtm", "w").write('<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet><Block index="0" name="flow">'
    '<DataSet index="0" file="p.pvti"/></Block><DataSet index="1" name="late" file="later.vti"/><DataSet index="2"/></vtkMultiBlockDataSet></VTKFile>')
open("in/cut.vtm", "w").write(open("in/b.vtm").read()[:-10])
P
draw() { isorender "in/$1" out.png --isovalue 50.5 --resolution 80x80 --quiet --json="$2.json" "${@:3}"; }
same() { # REFERENCE FILE [OPTION..]
    draw "$1" a
    draw "$2" b "${@:3}"
    python3 -c 'from check import *
expect(report("a.json")["image"]["hash"] == report("b.json")["image"]["hash"], sys.argv)' "$@"
}
same whole.vti p.pvti
same cells.vti c.pvti
same whole.vti t.pvd
same later.vti t.pvd --component 1
same whole.vti t.pvd --component 2
same whole.vti b.vtm
same later.vti b.vtm:/late
same later.vti b.vtm --grid /late/v
same whole.vti b.vtm:/0
cp in/p.pvti in/no_extension
same whole.vti no_extension
isorender in/t.pvd --info 2>&1 | grep -q 'note: time 0: using component 0 of 3'
isorender in/t.pvd --info 2>&1 | grep -q 'note: a time has several files: using the first (p.pvti)'
isorender in/b.vtm --info 2>&1 | grep -q 'note: several blocks: using /0 of 2'
isorender --series-of in/t.pvd step.png --isovalue 50.5 --resolution 40x40 --quiet
[ "$(ls step_*.png | wc -l)" -eq 3 ]
isorender_refuses 3 'in/few.pvti: truncated: its pieces do not cover its extent' in/few.pvti
isorender_refuses 3 "in/outside.pvti: not a readable .pvti file: a piece lies outside the image's extent" in/outside.pvti
isorender_refuses 3 'in/other.pvti: its piece d/p1.vti has another extent or type than it says' in/other.pvti
isorender_refuses 3 'in/kind.pvti: its piece d/p0.vti has another extent or type than it says' in/kind.pvti
isorender_refuses 3 'in/lost.pvti: in/d/lost.vti: ' in/lost.pvti
isorender_refuses 3 'in/itself.pvti: ' in/itself.pvti
isorender_refuses 3 'in/itself.pvd: ' in/itself.pvd
isorender_refuses 3 'in/mesh.pvd: in/mesh.stl: ' in/mesh.pvd
isorender_refuses 3 'in/cut.vtm: truncated: it does not end with </VTKFile>' in/cut.vtm
isorender_refuses 2 "in/b.vtm:/none: no block '/none', there are /0, /late" in/b.vtm:/none
isorender_refuses 2 'in/t.pvd: no component 3, there are 3' in/t.pvd --component 3
mkfifo in/d/fifo.vti
sed 's/lost.vti/fifo.vti/' in/lost.pvti >in/fifo.pvti
isorender_refuses 3 'in/fifo.pvti: in/d/fifo.vti: ' in/fifo.pvti
