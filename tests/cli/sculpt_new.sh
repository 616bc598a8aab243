# sessions that begin with a solid: volumes as geometry says, at any voxel size and number of threads; strokes that begin with one
# replay, in isosculpt and isorender; nonsense is refused in one line
make() { isosculpt --new "$1" --headless --mesh "$2.ply" --json="$2.json" --quiet "${@:3}"; }
make sphere:40 sphere
make box:40x30x20 box
make box:40x30x20,round=4 round
make capsule:20x50 capsule
make cylinder:30x40 cylinder
make torus:50x14 torus
make torus:50x14 fine --voxel-size 0.2
make torus:50x14 one --threads 1
cmp torus.ply one.ply
isosculpt --new box:40x30x20 --headless --output box.vdb --quiet
isosculpt --open box.vdb --headless --mesh again.ply --json=again.json --quiet
cat > strokes_of.py <<'P'
import strokes as s
head = s.header(version=5, source="torus", size=[50.0, 50.0, 14.0], round=0.0, radius=0.0, voxel_size=0.5, dims=[160, 160, 80],
                origin=[-39.75, -39.75, -19.75])
s.write("torus.strokes", [s.begin({"at": [18.0, 0.0, 7.0]}, tool="carve", radius=4.0), {"event": "end"}], head)
s.write("empty.strokes", [], head)
for name, changes in (("kind", {"source": "heart"}), ("size", {"size": [50.0, 50.0, 40.0]}), ("zero", {"size": [0.0, 50.0, 14.0]}),
                      ("many", {"size": [5e9, 5e9, 1.0]}), ("round", {"round": 1.0}), ("dims", {"dims": [160, 160, 81]}), ("newer", {"version": 6})):
    s.write(name + ".strokes", [], {**head, **changes})
P
python3 strokes_of.py
for name in torus empty; do isosculpt --replay $name.strokes --headless --mesh played_$name.ply --json=played_$name.json --quiet; done
isosculpt --replay torus.strokes --headless --voxel-size 0.25 --json=played_fine.json --mesh fine.ply --quiet
isosculpt --new torus:50x14 --replay torus.strokes --headless --voxel-size 0.5 --mesh with.ply --quiet
isorender torus.strokes torus.png --resolution 80x60 --quiet
for bad in kind size zero many round dims newer; do
    code=0
    isosculpt --replay $bad.strokes --headless --quiet --output bad.ply 2>message || code=$?
    [ "$code" = 3 ] && [ "$(wc -l <message)" = 1 ] && grep -q "$bad.strokes" message || { echo "$bad: $code"; cat message; exit 1; }
done
for bad in heart:3 box:3 sphere:1x2 sphere:0 sphere:-4 sphere:nan sphere:inf box:4x4x4,round=3 torus:10x9 capsule:9x5 sphere:4,round=1 box:4x4x4,edge=1 sphere; do
    code=0
    isosculpt --new "$bad" --headless --quiet --output bad.ply 2>message || code=$?
    [ "$code" = 2 ] && [ "$(wc -l <message)" = 1 ] || { echo "$bad: $code"; cat message; exit 1; }
done
code=0
isosculpt --new box:90x90x1 --voxel-size 1 --headless --quiet --output bad.ply 2>message || code=$?
[ "$code" = 2 ] && grep -q "1 mm thick needs voxels" message
code=0
isosculpt --new sphere:40 --open box.vdb --headless --quiet --output bad.ply 2>message || code=$?
[ "$code" = 2 ] && [ ! -e bad.ply ]
python3 - <<'P'
from check import *
from math import pi
mesh = lambda name: report(name + ".json")["mesh"]
torus = 2 * pi * pi * 18 * 49
a, b, c, r = 32, 22, 12, 4  # the core of the rounded box
wanted = {"sphere": (4 / 3 * pi * 20**3, 4 * pi * 400), "box": (24000, 2 * (1200 + 800 + 600)),
          "round": (a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) + 4 / 3 * pi * r**3,
                    2 * (a * b + b * c + c * a) + 2 * pi * r * (a + b + c) + 4 * pi * r * r),
          "capsule": (pi * 100 * 30 + 4 / 3 * pi * 1000, 2 * pi * 10 * 50), "cylinder": (pi * 225 * 40, 2 * pi * 225 + 2 * pi * 15 * 40),
          "torus": (torus, 4 * pi * pi * 18 * 7), "fine": (torus, 4 * pi * pi * 18 * 7), "played_empty": (torus, 4 * pi * pi * 18 * 7)}
for name, (volume, area) in wanted.items():
    got = mesh(name)
    expect(abs(got["volume"] / volume - 1) < 0.004 and abs(got["area"] / area - 1) < 0.012, (name, got, volume, area))
    expect(got["open_edges"] == 0, name)
expect(abs(mesh("again")["volume"] / mesh("box")["volume"] - 1) < 1e-6, "a .vdb of it")
expect(report("played_torus.json")["source"] == "torus" and mesh("played_torus")["volume"] < torus - 40, mesh("played_torus"))
expect(abs(mesh("played_fine")["volume"] / mesh("played_torus")["volume"] - 1) < 0.002, "another voxel size")
P
