# Three solids as a volume, a level set and a mesh: the largest is kept, and its share is said.
python3 - <<'P'
from check import *
def value(x, y, z):
    large = 2 <= x < 10 and 2 <= y < 10 and 2 <= z < 10
    small = 13 <= x < 17 and 13 <= y < 17 and 13 <= z < 17
    return 200.0 if large or small or (x, y, z) == (4, 15, 4) else 20.0
volume("in/three.mha", (20, 20, 20), value)
P
say() { isosculpt --headless --open "$@"; }
say in/three.mha --isovalue 100 --output in/all.stl --json=all.json
say in/three.mha --isovalue 100 --largest --output one.stl --json=one.json 2>one.err
say in/three.mha --isovalue 100 --min-size 60 --output two.stl --json=two.json 2>/dev/null
say in/all.stl --voxel-size 0.5 --largest --output mesh.stl --json=mesh.json 2>/dev/null
grep -q 'kept 1 of 3 parts of the solid, dropped 2 with 11.3 % of its volume' one.err
python3 - <<'P'
from check import *
expect("solid_parts" not in report("all.json") and report("all.json")["mesh"]["pieces"] == 3, report("all.json"))
one, two, mesh = report("one.json"), report("two.json"), report("mesh.json")
expect((one["solid_parts"]["kept"], one["solid_parts"]["dropped"], one["mesh"]["pieces"]) == (1, 2, 1), one)
expect((two["solid_parts"]["kept"], two["solid_parts"]["dropped"], two["mesh"]["pieces"]) == (2, 1, 2), two)
expect((mesh["solid_parts"]["kept"], mesh["mesh"]["pieces"]) == (1, 1), mesh)
for r in (one, two, mesh):
    expect(r["mesh"]["open_edges"] == 0 and r["mesh"]["area"] > 0, r["mesh"])
expect(one["mesh"]["euler"] == 2 and 380 < one["mesh"]["volume"] < 520, one["mesh"])
expect(abs(one["mesh"]["volume"] - mesh["mesh"]["volume"]) < 0.05 * one["mesh"]["volume"], one["mesh"], mesh["mesh"])
P
if isosculpt --headless --open in/three.mha --isovalue 100 --min-size 1e4 --output none.stl 2>none.err; then exit 1; fi
grep -q '^isosculpt: in/three.mha: no part of the solid has 10000 mm3: the largest of 3 has 512$' none.err
test ! -e none.stl
