# isosculpt makes a solid of lines: the tubes around them, printable and as a level set
printf '1 1 0 0 0 5 -1\n2 1 20 0 0 5 1\n3 1 40 0 0 5 2\n' >in/capsule.swc
isosculpt --open in/capsule.swc --voxel-size 0.5 --headless --mesh a.stl --output a.vdb --json=a.json --quiet
python3 - <<'P'
from check import *
import math
mesh = report("a.json")["mesh"]
wanted = math.pi * 25 * 40 + 4 / 3 * math.pi * 125
expect(mesh["pieces"] == 1 and mesh["open_edges"] == 0 and mesh["euler"] == 2, mesh)
expect(abs(mesh["volume"] / wanted - 1) < 0.01, mesh, wanted)
P
isorender a.vdb a.png --quiet
code=0
isosculpt --open in/capsule.swc --crop 0,1,0,1,0,1 --headless --mesh b.stl 2>said || code=$?
[ $code -eq 2 ]
grep -q "is a file of lines: --crop needs a volume" said
rm said
