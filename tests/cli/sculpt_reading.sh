# isosculpt reads volumes with isorender's options: the mesh that it makes lies where isorender's does.
python3 - <<'P'
from check import *
ball("in/ball.mha", header="")
data = open("in/ball.mha", "rb").read()
open("in/ball.raw", "wb").write(b"12345" + data[data.index(b"LOCAL\n") + 6:])
P
reading="--raw 24x24x24:float:little:5 --spacing 0.5,0.5,0.75 --crop-mm 1,9.5,0,12,0,9"
isorender in/ball.raw $reading --isovalue 500 --no-image --json=a.json --quiet
isosculpt --open in/ball.raw $reading --isovalue 500 --headless --voxel-size 0.25 --mesh b.stl --json=b.json --quiet
python3 - <<'P'
from check import *
import struct
stl = open("b.stl", "rb").read()
count = struct.unpack_from("<I", stl, 80)[0]
corners = [struct.unpack_from("<3f", stl, 84 + 50 * i + 12 + 12 * k) for i in range(count) for k in range(3)]
wanted = report("a.json")["bounds_world"]
for axis in range(3):
    values = [c[axis] for c in corners]
    expect(abs(min(values) - wanted[2 * axis]) < 0.2 and abs(max(values) - wanted[2 * axis + 1]) < 0.2,
           axis, min(values), max(values), wanted)
expect(wanted[0] > 0.9 and wanted[5] == 9, wanted)
P
isocompare report in/ball.raw $reading --isovalue 500 --side 64 --output page --quiet && [ -s page/report.html ]
# status PATTERN OPTION ...
fails() { refuses "$1" "$2" isosculpt "${@:3}"; }
printf 'v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' >in/tetra.obj
fails 2 "in/tetra.obj: is a mesh: --grid needs a volume" --open in/tetra.obj --grid x --headless --mesh c.stl
fails 2 "--raw needs a file to open" --replay "$volumes/bear.strokes" --raw 24x24x24:float --headless --mesh c.stl
fails 2 "--crop needs a file to open" "$volumes/bear.strokes" --crop 0,1,0,1,0,1
fails 2 "--crop and --crop-mm" --open in/ball.mha --crop 0,1,0,1,0,1 --crop-mm 0,1,0,1,0,1 --headless --mesh c.stl
fails 2 "in/ball.mha: --crop reaches outside" --open in/ball.mha --crop 0,1,0,1,0,99 --isovalue 500 --headless --mesh c.stl
fails 5 "max-memory" --open in/ball.mha --max-memory 10K --isovalue 500 --headless --mesh c.stl
[ ! -e c.stl ]
