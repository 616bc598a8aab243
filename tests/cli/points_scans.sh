# scans without normals and radii, drawn from estimates: against the same file drawn as a mesh, at most one in a thousand pixels
# is empty.
points=${ISO_TEST_VOLUMES:-}/../points
[ -f "$points/INDEX.tsv" ] || { echo "skipped: no real points beside '${ISO_TEST_VOLUMES:-}'"; exit 77; }
for name in bunny horse; do
    isorender "$points/scans/$name.ply" $name.png --normals auto --json=$name.json --quiet --resolution 600x600 --fit box --background 0000FF
    isorender --surface "$points/scans/$name.ply" mesh_$name.png --quiet --resolution 600x600 --fit box --background 0000FF
done
python3 - <<'P'
from check import *
for name in ("bunny", "horse"):
    p = report(name + ".json")["primitives"]
    expect(p["estimated_normals"] == p["estimated_radii"] == p["points"], p)
    ours, mesh = Png(name + ".png").rows, Png("mesh_" + name + ".png").rows
    empty_color = (0, 0, 255)
    def shows(rows, x, y):
        return tuple(rows[y][x][:3]) != empty_color
    inside = [(x, y) for y in range(1, 599) for x in range(1, 599)
              if all(shows(mesh, x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1))]
    empty = sum(not shows(ours, x, y) for x, y in inside)
    print(name, len(inside), "pixels inside,", empty, "empty")
    expect(len(inside) > 30000 and empty <= 0.001 * len(inside), name, len(inside), empty)
P
