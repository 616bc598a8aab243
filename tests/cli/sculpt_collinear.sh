# A triangle without area inside a cube is no surface: it leaves no specks in the solid.
python3 - <<'P'
corners = [(x, y, z) for z in (0, 10) for y in (0, 10) for x in (0, 10)]
faces = [(0, 2, 3), (4, 5, 7), (0, 1, 5), (2, 6, 7), (0, 4, 6), (1, 3, 7), (0, 3, 1), (4, 7, 6), (0, 5, 4), (2, 7, 3),
         (0, 6, 2), (1, 7, 5)]
with open("in/cube.obj", "w") as file:
    for point in corners + [(3, 3, 3), (4.5, 4.5, 4.5), (6, 6, 6)]:
        file.write("v %g %g %g\n" % point)
    for face in faces + [(8, 9, 10)]:
        file.write("f %d %d %d\n" % tuple(corner + 1 for corner in face))
P
isosculpt --open in/cube.obj --voxel-size .5 --headless --output cube.stl --json=cube.json --quiet
python3 - <<'P'
from check import *
mesh = report("cube.json")["mesh"]
expect(mesh["pieces"] == 1 and abs(mesh["volume"] - 1000) < 5 and mesh["open_edges"] == 0, mesh)
P
