# exit: 3
# stderr: isosculpt: in/sheet.obj: the mesh is open: 80 open edges; the largest hole measures 28.* mm, and only holes up to 2 mm can be closed
python3 - <<'P'
import math
with open("in/sheet.obj", "w") as out:
    for i in range(441): out.write("v %d %d %g\n" % (i // 21, i % 21, math.sin(i // 21 * 0.7 + i % 21)))
    for i in range(400):
        a = i // 20 * 21 + i % 20 + 1
        out.write("f %d %d %d %d\n" % (a, a + 21, a + 22, a + 1))
P
isosculpt --open in/sheet.obj --headless --output o.vdb --json=o.json
