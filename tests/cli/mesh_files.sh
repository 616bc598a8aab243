python3 -c 'from check import *; ball("in/ball.mha")'
for kind in ply stl obj; do
    isorender in/ball.mha --isovalue 500 --mesh m.$kind --no-image --json=$kind.json --quiet
done
python3 - <<'P'
import struct
from check import *
j = report("stl.json")["primitives"]
expect("points" not in j, j)
stl = open("m.stl", "rb").read()
expect(struct.unpack("<I", stl[80:84])[0] == j["triangles"] and len(stl) == 84 + 50 * j["triangles"], len(stl))
obj = open("m.obj").read().splitlines()
expect(sum(l.startswith("v ") for l in obj) == j["vertices"], "vertices")
expect(sum(l.startswith("f ") for l in obj) == j["triangles"], "faces")
ply = open("m.ply", "rb").read().split(b"end_header\n")[0].decode()
expect("element vertex %d\n" % j["vertices"] in ply and "element face %d\n" % j["triangles"] in ply, ply)
P
