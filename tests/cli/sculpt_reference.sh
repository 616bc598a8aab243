# Files as the reference: lines, glyphs and surfaces, told by what they hold; they change nothing but the pictures.
python3 - <<'P'
from check import *
open("in/axis.swc", "w").write("1 1 -20 0 0 1 -1\n2 1 20 0 0 2 1\n")
open("in/dots.csv", "w").write("x,y,z,radius\n0,0,15,3\n0,-20,0,2\n")
open("in/lines.obj", "w").write("v 0 0 -30\nv 0 0 30\nl 1 2\n")
open("in/mesh.obj", "w").write("v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
rows = "0 0 0\n9 0 0\n0 9 0\n0 0 9\n"
open("in/points.ply", "w").write(head + "end_header\n" + rows)
open("in/edges.ply", "w").write(head + "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n" + rows + "0 1\n")
open("in/mesh.ply", "w").write(head + "element face 4\nproperty list uchar int vertex_indices\nend_header\n" + rows +
                               "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
open("in/far.swc", "w").write("1 1 9000 0 0 1 -1\n2 1 9020 0 0 2 1\n")
open("in/empty.ply", "w").write(head.replace("4", "0") + "end_header\n")
P
play() { isosculpt --replay $volumes/bear.strokes --headless --voxel-size 2 --draw --resolution 160x100 "$@"; }
play --output plain.ply --quiet
for file in axis.swc dots.csv lines.obj mesh.obj points.ply edges.ply mesh.ply; do
    play --output with.ply --reference in/$file --quiet 2>notes
    cmp plain.ply with.ply
    [ ! -s notes ]
done
play --output with.ply --reference in/axis.swc --reference in/dots.csv --x-ray over
cmp plain.ply with.ply
play --output with.ply --reference in/far.swc 2>notes
grep -q "in/far.swc lies beside the rest: .* --space ras" notes
play --output with.ply --reference in/far.swc --space ras 2>notes
grep -q "in/far.swc lies beside the rest: .* --space lps" notes
# a reference is an input, which no output overwrites
cp in/mesh.ply before.ply
ln -s in/mesh.ply link.ply
refuses 2 'link.ply: an output would overwrite the input in/mesh.ply' play --reference in/mesh.ply --output link.ply --quiet
cmp before.ply in/mesh.ply
fails() { refuses "$1" "$2" isosculpt --headless --quiet --output bad.ply "${@:3}"; }
bear="--replay $volumes/bear.strokes --voxel-size 2"
fails 2 "--reference is for pictures" $bear --reference in/axis.swc
fails 2 "--space is for --reference" $bear --draw --space ras
fails 2 "mesh.obj: a surface is the only reference" $bear --draw --reference in/axis.swc --reference in/mesh.obj
fails 3 "in/none.trk: " $bear --draw --reference in/none.trk
fails 6 "in/empty.ply: holds no" $bear --draw --reference in/empty.ply
awk 'BEGIN { for (i = 1; i <= 300000; i++) print i, 3, i * 0.001, 0, 0, 1, (i > 1 ? i - 1 : -1) }' >in/many.swc
fails 5 "in/many.swc: " $bear --draw --reference in/many.swc --max-memory 30M
rm -f said notes
