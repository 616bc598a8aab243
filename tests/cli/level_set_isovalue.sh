# The isovalue of a level set is in mm: the surface 1 mm outside has the same size whatever the voxels are.
isorender scene:sphere:64 --mesh ball.stl --no-image --quiet
isosculpt --open ball.stl --headless --voxel-size 1 --output in.vdb --quiet 2>error.txt || { grep -q "not installed" error.txt && { echo "skipped: without OpenVDB"; exit 77; }; cat error.txt; exit 1; }
isosculpt --open ball.stl --headless --voxel-size 0.5 --output fine.vdb --quiet
for name in in fine; do
    for isovalue in 0 1; do
        isorender $name.vdb --isovalue $isovalue --no-image --json=$name$isovalue.json --quiet
    done
    isosculpt --open $name.vdb --isovalue 1 --headless --mesh $name.stl --quiet
    isorender $name.vdb --info >$name.txt
done
grep -q '^ *range *-1.5 .. 1.5$' fine.txt && grep -q '^ *range *-3 .. 3$' in.txt
status=0
isorender fine.vdb out.png --isovalue 1.5 2>error.txt || status=$?
[ $status -eq 6 ] && [ ! -e out.png ] && grep -q 'narrow band is 1.5 mm wide' error.txt
isorender fine.vdb out.png --isovalue 1.25 --resolution 64x64 2>error.txt
grep -q "note: isovalue 1.25 lies within a voxel of the end" error.txt
python3 - <<'P'
from check import *
import struct
def radius(name):
    b = report(name + ".json")["bounds_world"]
    return (b[1] - b[0]) / 2
for name in ("in", "fine"):
    expect(abs(radius(name + "1") - radius(name + "0") - 1) < 0.01, name, radius(name + "0"), radius(name + "1"))
    stl = open(name + ".stl", "rb").read()
    count = struct.unpack_from("<I", stl, 80)[0]
    x = [struct.unpack_from("<f", stl, 84 + 50 * i + 12)[0] for i in range(count)]
    expect(abs((max(x) - min(x)) / 2 - radius("fine1")) < 0.05, name, (max(x) - min(x)) / 2, radius("fine1"))
P
