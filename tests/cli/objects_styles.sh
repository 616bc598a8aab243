# lines as tubes, ribbons and lines of one width: the file's normals point to the eye that is in front of it
python3 - <<'P'
open("in/flat.vtk", "w").write("""# vtk DataFile Version 3.0
a line along x whose normals point along y
ASCII
DATASET POLYDATA
POINTS 2 float
-5 0 0 5 0 0
LINES 1 3
2 0 1
POINT_DATA 2
NORMALS n float
0 1 0 0 1 0
""")
open("in/bare.obj", "w").write("v -5 0 0\nv 5 0 0\nl 1 2\n")
P
render() { # NAME FILE OPTION..
    local name=$1 file=$2
    shift 2
    isorender --lines $file --tube-radius 1 $name.png "$@" --orthographic --mm-per-pixel 0.125 --samples 1 \
        --camera-focal-point 0,0,0 --resolution 128x64 --json=$name.json --quiet
}
render tube in/flat.vtk --camera-position 0,-50,0
render front in/flat.vtk --camera-position 0,-50,0 --line-style ribbon
render slanted in/flat.vtk --camera-position 0,-30,40 --line-style ribbon
render line in/flat.vtk --camera-position 0,-50,0 --line-style line
render wide in/flat.vtk --camera-position 0,-50,0 --line-style line --line-min-pixels 4
render bare in/bare.obj --camera-position 0,30,40 --line-style ribbon # its normals point along y or z
python3 - <<'P'
import json
samples = {n: json.load(open(n + ".json"))["objects"][0]["samples"] for n in ("tube", "front", "slanted", "line", "wide", "bare")}
assert samples["front"] == 80 * 16, samples  # 10 mm by 2 mm, 8 pixels a mm
assert abs(samples["slanted"] - 80 * 16 * 0.6) <= 80, samples
assert abs(samples["tube"] - (80 * 16 + 3.14159 * 64)) < 30, samples
assert 80 <= samples["line"] <= 164 and abs(samples["wide"] - 4 * 80) <= 20, samples
assert abs(samples["bare"] - 80 * 16 * 0.75) <= 240, samples
P
code=0
isorender --lines in/flat.vtk none.png --line-style line --line-min-pixels 0 2>notes || code=$?
[ $code -eq 2 ]
grep -q "neither radius nor width" notes
