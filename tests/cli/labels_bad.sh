# Labels that are not there, no labels at all, tables that are none, and options without labels: one line each, and no file.
python3 - <<'P'
import array
n = 20
def write(name, kind, code, values):
    head = "NRRD0004\ntype: %s\ndimension: 3\nsizes: 20 20 20\nspacings: 1 1 1\nencoding: raw\nendian: little\n\n" % kind
    open("in/" + name, "wb").write(head.encode() + array.array(code, values).tobytes())
box = [1 + (x > 9) if 4 < x < 16 and 4 < y < 16 and 4 < z < 16 else 0 for z in range(n) for y in range(n) for x in range(n)]
write("labels.nrrd", "uint8", "B", box)
write("floats.nrrd", "float", "f", [v * 0.37 for v in box])
write("large.nrrd", "uint32", "I", [v * 65536 for v in box])
write("below.nrrd", "int16", "h", [v - 1 for v in box])
write("none.nrrd", "uint8", "B", [0] * n**3)
write("one.nrrd", "uint8", "B", [0] * 4210 + [5] + [0] * (n**3 - 4211))
write("all.nrrd", "uint8", "B", [4] * n**3)
write("many.nrrd", "uint16", "H", [min(i * 9, 65535) for i in range(n**3)])
write("cells.nrrd", "uint8", "B", [min(255, 1 + x // 4 + 5 * (y // 4) + 25 * (z // 2)) for z in range(n) for y in range(n) for x in range(n)])
P
refuses 2 "there is no label 7: there are 1, 2" isorender --labels in/labels.nrrd --label 7 bad.png || exit 1
refuses 2 "there is no label liver: there are 1, 2" isorender --labels in/labels.nrrd --label 1,liver bad.png || exit 1
refuses 2 "'blueish' is neither an opacity from 0 to 1 nor a colour" isorender --labels in/labels.nrrd --label 1:blueish bad.png || exit 1
refuses 2 "is no label" isorender --labels in/labels.nrrd --label 1,,2 bad.png || exit 1
refuses 6 "all opacities are 0" isorender --labels in/labels.nrrd --label all:0 bad.png || exit 1
refuses 3 "in/floats.nrrd: not a segmentation: labels are whole numbers from 0 to 65535, and a voxel is 0.[37]" isorender --labels in/floats.nrrd bad.png || exit 1
refuses 3 "a voxel is 65536\|a voxel is 131072" isorender in/large.nrrd --smooth bad.png || exit 1
refuses 3 "a voxel is -1" isorender in/below.nrrd --smooth bad.png || exit 1
refuses 6 "no label is in it: every voxel is 0" isorender in/none.nrrd --smooth bad.png || exit 1
refuses 3 "" isorender --labels in/missing.nrrd bad.png || exit 1
refuses 3 "sparse grid of distances" isorender --labels scene:sphere:32 bad.png || exit 1
printf '1 one 300 0 0 0\n' >in/bad.txt
refuses 3 "in/bad.txt: line 1 is no label" isorender --labels in/labels.nrrd --label-table in/bad.txt bad.png || exit 1
printf '# nothing\n' >in/bad.txt
refuses 3 "in/bad.txt: no label is in it" isorender --labels in/labels.nrrd --label-table in/bad.txt bad.png || exit 1
for option in "--label 1" "--label-table in/bad.txt" "--table bad.csv"; do
    refuses 2 "is for labels: it needs --labels FILE or --smooth" isorender scene:torus:32 bad.png $option || exit 1
done
refuses 2 "give one of them" isorender in/labels.nrrd --smooth --labels in/labels.nrrd bad.png || exit 1
refuses 2 "labels cannot be combined with --ior" isorender in/labels.nrrd --smooth --ior 1.5 bad.png || exit 1
refuses 2 "cannot draw translucent surfaces" isorender in/labels.nrrd --smooth --label 1:0.5 --method mesh bad.png || exit 1
refuses 2 "shows the values of a volume" isorender in/labels.nrrd --smooth --clip 'x<9' --cap slice bad.png || exit 1
refuses 7 "in/no/t.csv" isorender --labels in/labels.nrrd --table in/no/t.csv bad.png || exit 1
refuses 2 "2 labels are written as the objects of an .obj" isorender in/labels.nrrd --smooth --mesh bad.ply --no-image || exit 1
# The values of a scan are no labels, unless it is said that they are.
refuses 2 "in/many.nrrd: these are 7282 values of which neighbours mostly differ, .* without --smooth (--label all" isorender in/many.nrrd --smooth bad.png || exit 1
refuses 2 "in/many.nrrd: these are 7282 .* without --labels" isorender in/labels.nrrd --labels in/many.nrrd bad.png --quiet || exit 1
# One voxel, a volume of one label, 200 small cells and 7,282 labels are drawn.
isorender in/cells.nrrd --smooth cells.png --quiet || exit 1
isorender in/one.nrrd --smooth one.png --quiet || exit 1
isorender in/all.nrrd --smooth all.png --quiet || exit 1
isorender in/many.nrrd --smooth many.png --quiet --label all --table many.csv || exit 1
[ "$(wc -l <many.csv)" -eq 7283 ] || { echo "many.csv has $(wc -l <many.csv) lines"; exit 1; }
isorender in/many.nrrd --smooth few.png --label '9-540:0.5' --quiet || exit 1
refuses 2 "translucent labels: up to" isorender in/many.nrrd --smooth bad.png --label all:0.5 || exit 1
