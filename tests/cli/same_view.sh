# several inputs: --same-view gives all the isovalue and the camera of the first; --json without a file is a line for each.
python3 - <<'P'
from check import *
ball("in/large.mha", radius=8.0)
ball("in/small.mha", radius=4.0)
P
isorender in/large.mha in/small.mha --output '{model}.png' --resolution 60x60 --same-view --json >lines 2>log
isorender in/large.mha in/small.mha --output '{model}_own.png' --resolution 60x60 --fit box --json --quiet >own
[ "$(grep -c isovalue log)" -eq 1 ]
python3 - <<'P'
import json
from check import *
same, own = ([json.loads(line) for line in open(name)] for name in ("lines", "own"))
expect(len(same) == len(own) == 2 and [j["volume"]["path"] for j in same] == ["in/large.mha", "in/small.mha"], same)
expect(same[0]["camera"] == same[1]["camera"] and same[0]["isovalue"] == same[1]["isovalue"], same)
expect(own[0]["camera"] != own[1]["camera"] and own[0]["isovalue"] != own[1]["isovalue"], own)
expect(same[0]["image"]["hash"] == own[0]["image"]["hash"] and same[1]["image"]["covered"] < own[1]["image"]["covered"] / 2, same)
P
# each picture draws itself again without the others: it holds the camera and isovalue that it shares
isorender in/large.mha --no-image --points in/points.ply --quiet
for how in "--azimuth 31 --up +y" "--zoom 1.3 --camera iso --margin 0.1" "--mm-per-pixel 0.3"; do
    isorender in/large.mha in/small.mha in/points.ply -o 'shared-{n}.png' --resolution 67x49 --same-view --fit box $how --quiet
    for number in 0 1 2; do
        isorender --again shared-$number.png -o again.png --quiet
        cmp shared-$number.png again.png
    done
done
isorender in/large.mha in/small.mha -o 'shared-{n}.png' --resolution 67x49 --same-view --orthographic --elevation 17 --quiet
isorender --again shared-1.png -o again.png --quiet
cmp shared-1.png again.png
# an input that fails has no line, and the others have theirs
! isorender in/none.mha in/small.mha --output '{model}.png' --resolution 60x60 --same-view --json --quiet >lines 2>/dev/null
[ "$(wc -l <lines)" -eq 1 ]
# a single report is indented
[ "$(isorender in/small.mha --no-image --json --quiet | wc -l)" -gt 20 ]
# each volume has its own component
python3 - <<'P'
import struct
from check import *
side = 24
def two(path, first, second):
    middle = (side - 1) / 2
    with open(path, "wb") as f:
        f.write(("ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementNumberOfChannels = 2\nElementType = MET_FLOAT\n"
                 "ElementByteOrderMSB = False\nElementDataFile = LOCAL\n" % (side, side, side)).encode())
        for z in range(side):
            for y in range(side):
                for x in range(side):
                    d = ((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2) ** 0.5
                    f.write(struct.pack("<2f", *(max(0.0, 1000 - 500 * d / r) for r in (first, second))))
two("in/two.mha", 4.0, 9.0)
P
isorender in/large.mha v.png --volume in/two.mha --volume in/two.mha --volume-component 0 --volume-component 1 --volume-isovalue 500 --isovalue 500 \
    --resolution 60x60 --json=v.json --quiet
python3 - <<'P'
from check import *
a, b = report("v.json")["volumes"]
size = lambda v: v["bounds_world"][1] - v["bounds_world"][0]
expect(a["component"] == 0 and b["component"] == 1 and size(a) < 9 and size(b) > 16, a, b)
P
isorender_refuses 2 "in/two.mha: .*component 2" in/large.mha --volume in/two.mha --volume-component 2
isorender_refuses 2 "volume-component: 'x' is not a whole number" in/large.mha --volume in/two.mha --volume-component x
isorender_refuses 2 "volume-component" in/large.mha --volume-component 1
