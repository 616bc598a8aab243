# --freeze: what a volume has at a second isovalue stays when all around it is carved away, and other labels than the one that is
# sculpted are not reached; the same bytes by any number of threads; what cannot be frozen is refused in one line
cat > make.py <<'P'
import struct

import strokes as s

def write(name, value, kind, code, n=48):
    data = b"".join(struct.pack(code, value(x - 23.5, y - 23.5, z - 23.5)) for z in range(n) for y in range(n) for x in range(n))
    with open(name, "wb") as file:
        file.write(b"NRRD0004\ntype: %s\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\nendian: little\nencoding: raw\n"
                   b"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-23.5,-23.5,-23.5)\n\n" % (kind, n, n, n) + data)

write("head.nrrd", lambda x, y, z: 100 - (x * x + y * y + z * z) ** 0.5, b"float", "<f")
write("seg.nrrd", lambda x, y, z: 1 if (x + 6) ** 2 + y * y + z * z < 100 else 2 if x > 4 and max(x, abs(y), abs(z)) < 15 else 0, b"uint8", "<B")
head = s.header(voxel_size=1.0, dims=[128, 128, 128], origin=[-63.5] * 3)
s.write("carve.strokes", [s.begin({"at": [0.0, 0.0, 0.0]}, tool="carve", radius=15.0), {"event": "end"}], head)
s.write("grow.strokes", [s.begin({"at": [0.0, 0.0, 0.0]}, tool="add", radius=12.0), {"event": "end"}], head)
P
python3 make.py
play() { isosculpt --headless --quiet --open "$1" --replay "$2.strokes" --mesh "$3.ply" --json="$3.json" "${@:4}"; }
play head.nrrd carve whole --isovalue 80
play head.nrrd carve frozen --isovalue 80 --freeze 90
play head.nrrd carve one --isovalue 80 --freeze 90 --threads 1
cmp frozen.ply one.ply
play seg.nrrd grow grown --label 1
play seg.nrrd grow kept --label 1 --freeze labels
refused() { # STATUS WORDS ARGUMENTS
    local code=0
    isosculpt --headless --quiet --mesh bad.ply "${@:3}" 2>message || code=$?
    [ "$code" = "$1" ] && [ "$(wc -l <message)" = 1 ] && grep -q "$2" message || { echo "$*: $code"; cat message; exit 1; }
}
refused 6 "head.nrrd: --freeze: there is nothing to freeze" --open head.nrrd --isovalue 80 --freeze 1000
refused 2 "neither" --open head.nrrd --isovalue 80 --freeze bone
refused 2 "needs --label" --open head.nrrd --isovalue 80 --freeze labels
refused 2 "needs a volume" --replay carve.strokes --freeze 3
[ ! -e bad.ply ]
python3 - <<'P'
from check import *
from math import pi
mesh = {name: report(name + ".json")["mesh"] for name in ("whole", "frozen", "grown", "kept")}
ball = lambda r: 4 / 3 * pi * r**3
near = lambda value, wanted: abs(value / wanted - 1) < 0.02
expect(near(mesh["whole"]["volume"], ball(20) - ball(15)) and mesh["whole"]["pieces"] == 2, mesh["whole"])
expect(near(mesh["frozen"]["volume"], ball(20) - ball(15) + ball(10)) and mesh["frozen"]["pieces"] == 3, mesh["frozen"])
# the added ball reaches x = 12; the other label begins at 4.5
cap = pi * 7.5**2 * (3 * 12 - 7.5) / 3
expect(near(mesh["grown"]["volume"] - mesh["kept"]["volume"], cap) or abs(mesh["grown"]["volume"] - mesh["kept"]["volume"] - cap) < 0.15 * cap, (mesh, cap))
P
