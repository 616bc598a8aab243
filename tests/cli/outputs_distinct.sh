# No output may be a file that is read or another output, under whatever name: status 2, one line that names both,
# and every file as it was.
mkdir in/slices out
python3 - <<'P'
from check import *
ball("in/ball.mha")
data = open("in/ball.mha", "rb").read().split(b"LOCAL\n", 1)[1]
for name in "d.raw", "list0.raw", "n.raw":
    open("in/" + name, "wb").write(data)
head = "ObjectType = Image\nNDims = 3\nDimSize = 24 24 24\nElementType = MET_FLOAT\nElementDataFile = "
open("in/d.mhd", "w").write(head + "d.raw\n")
open("in/list.mhd", "w").write(head + "LIST\nlist0.raw\n")
nrrd = "NRRD0004\ntype: float\ndimension: 3\nsizes: 24 24 24\nencoding: raw\nendian: little\ndata file: "
open("in/n.nhdr", "w").write(nrrd + "n.raw\n")
open("in/l.nhdr", "w").write(nrrd + "LIST 3\nn.raw\n")
open("in/p.nhdr", "w").write(nrrd + "list%d.raw 0 0 1 3\n")
open("in/pair.hdr", "wb").write(nifti_header((24, 24, 24), 16, 32))
open("in/pair.img", "wb").write(data)
P
isorender in/ball.mha --no-image --points in/p.ply --mesh in/m.stl --quiet
isorender in/ball.mha in/t.png --resolution 64x64 --quiet
isorender in/ball.mha in/c.png --resolution 64x64 --quiet --color FF0000
ln -s ../in/d.raw out/link.ply
ln in/d.raw out/hard.obj
ln -s nowhere.ply out/dangling.ply
sums() { find in out -type f -exec sha256sum {} + | sort; }
sums >before
# refused OTHER-NAME PROGRAM ARGUMENTS...
refused() {
    local other=$1 code=0
    shift
    "$@" >said 2>&1 || code=$?
    [ $code = 2 ] && [ "$(grep -c '' said)" = 1 ] && grep -q "output" said && grep -qF "$other" said || {
        cat said
        echo "status $code: $*"
        exit 1
    }
    sums | cmp -s before - && [ "$(ls)" = "$(printf 'before\nin\nout\nsaid')" ] || { ls . out; echo "changed by: $*"; exit 1; }
}
refused in/ball.mha isorender in/ball.mha -o in/ball.mha.png --json=in/../in/ball.mha
refused in/d.raw isorender in/d.mhd --no-image --json=in/d.raw
refused in/d.raw isorender in/d.mhd --no-image --points out/link.ply
refused in/d.raw isorender in/d.mhd --no-image --mesh out/../out/./hard.obj
refused in/list0.raw isorender in/list.mhd --info --json=in/list0.raw
refused in/n.raw isorender in/n.nhdr --info --json=in/n.raw
refused in/n.raw isorender in/l.nhdr --info --json=in/n.raw
refused in/list0.raw isorender in/p.nhdr --info --json=in/list0.raw
refused in/pair.img isorender in/pair.hdr --info --json=in/pair.img
refused in/pair.hdr isorender in/pair.img --info --json=in/pair.hdr
refused in/p.ply isorender in/p.ply --no-image --points in/p.ply
refused out/a.ply isorender in/ball.mha --no-image --points out/a.ply --mesh out/../out/a.ply
refused out/dangling.ply isorender in/ball.mha --no-image --points out/dangling.ply --mesh out/nowhere.ply
refused in/d.raw isorender in/ball.mha in/d.mhd -o "{model}.png" --json=in/d.raw
refused in/d.raw isorender in/ball.mha in/d.mhd -o "out/{model}.png" --json="in/{model}.raw"
refused out/t_001.png isorender in/ball.mha --turntable 3 -o out/t_{n:3}.png --json=out/t_001.png
refused "standard input" isorender - --info --json=in/ball.mha <in/ball.mha
refused in/t.png isocompare images in/t.png in/c.png --json=in/t.png --quiet
refused out/d isocompare images in/t.png in/c.png --json=out/d --difference out/./d --quiet
ln -s ../in/d.raw out/report.json
sums >before
refused in/d.raw isocompare report in/d.mhd --side 64 --output out --quiet
rm out/report.json
sums >before
bear=$volumes/bear.strokes
cp "$bear" in/a.strokes
sums >before
refused in/a.strokes isosculpt --headless --replay in/a.strokes --voxel-size 2 --json=in/a.strokes
refused in/m.stl isosculpt --headless --open in/m.stl --voxel-size 2 -o in/m.stl
refused x.stl isosculpt --headless --replay in/a.strokes --voxel-size 2 -o x.stl --json=x.stl
refused in/d.raw isosculpt --headless --open in/d.mhd --isovalue 500 -o out/s.stl --json=in/d.raw
# Devices are no files, and links that lead nowhere are outputs like any other.
ln -s /dev/null out/null.png
isorender in/ball.mha out/null.png --json=/dev/null --quiet --resolution 64x64
isorender in/ball.mha --no-image --points out/dangling.ply --quiet
[ -L out/dangling.ply ] && [ -s out/nowhere.ply ]
