# One line for each file that is written, also without a picture; it says whether a mesh is closed. --quiet hides it.
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500 --no-image --mesh ball.stl 2>ball.txt
isorender in/ball.mha --isovalue 500 --no-image --points ball.ply --mesh cut.obj --crop 0,11,0,23,0,23 --json=cut.json 2>cut.txt
isorender in/ball.mha --isovalue 500 --mesh capped.stl --crop 0,11,0,23,0,23 --closed --resolution 32x32 ball.png 2>capped.txt
isorender in/ball.mha --isovalue 500 --no-image --mesh quiet.stl --points quiet.ply -q 2>quiet.txt
cmp ball.stl quiet.stl
test ! -s quiet.txt
python3 - <<'P'
from check import *
import re
def lines(name): return open(name).read().splitlines()
expect(len(lines("ball.txt")) == 1 and re.fullmatch(r"isorender: in/ball.mha: wrote ball.stl: \d+ triangles, closed", lines("ball.txt")[0]), lines("ball.txt"))
cut, j = lines("cut.txt"), report("cut.json")
expect(len(cut) == 2 and cut[0] == "isorender: in/ball.mha: wrote ball.ply: %d points" % j["primitives"]["points"], cut)
expect(cut[1] == "isorender: in/ball.mha: wrote cut.obj: %d triangles, %d open edges where the volume's border or voxels that "
       "are no numbers cut the solid: --closed caps it there" % (j["primitives"]["triangles"], j["mesh"]["open_edges"]), cut)
expect(j["mesh"]["open_edges"] > 0, j["mesh"])
capped = lines("capped.txt")
expect(len(capped) == 2 and capped[0].endswith(" triangles, closed") and capped[1].endswith("wrote ball.png"), capped)
P
