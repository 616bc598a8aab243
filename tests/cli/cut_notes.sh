# What is said of cuts and slices that show little or nothing: planes beside the volume, edge-on and seen from behind, and which
# values slices show; nothing is said where the cut is seen. --window auto; the camera that a note names shows the cut.
cat >in/make.py <<'P'
# 24 x 20 x 16 voxels of 1 mm: a ball of radius 7 around 12,10,8, rising from 0 to 100, its middle voxel 30,000.
import array
values = array.array("h")
for z in range(16):
    for y in range(20):
        for x in range(24):
            values.append(max(0, round(100 - 10 * ((x - 12)**2 + (y - 10)**2 + (z - 8)**2)**.5)))
values[(8 * 20 + 10) * 24 + 12] = 30000
head = "NRRD0005\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 24 20 16\n"
head += "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\nendian: little\n\n"
open("in/v.nrrd", "wb").write(head.encode() + values.tobytes())
P
python3 in/make.py
draw() { isorender in/v.nrrd "$1.png" --resolution 64x64 --samples 1 --isovalue 30 "${@:2}" 2>"$1.said" || echo "failed: $*"; }
says() { grep -q -- "note: $2" "$1.said" || { echo "$1 does not say '$2'"; cat "$1.said"; exit 1; }; }
quiet() { ! grep -q -e "seen\|nothing\|meet" "$1.said" || { echo "$1 says something"; cat "$1.said"; exit 1; }; }
draw far --clip 'x>900';                says far "--clip x>900 removes nothing: the picture reaches from "
draw ball --clip sphere:0,0,0,2;        says ball "--clip sphere:0,0,0,2 removes nothing"
draw box --clip box:-9,-9,-9,0,0,0;     says box "--clip box:-9,-9,-9,0,0,0 removes nothing"
draw keep --clip keep:sphere:12,10,8,99; says keep "--clip keep:sphere:12,10,8,99 removes nothing"
draw behind --clip 'x<12' --camera left; says behind "--clip x<12 is seen from behind: --camera right looks at it"
draw kept --clip 'keep:y<10' --camera front; says kept "--clip keep:y<10 is seen from behind: --camera back looks at it"
draw slant --clip 12,10,8:1,1,0 --camera right; says slant "--clip 12,10,8:1,1,0 is seen from behind: --azimuth"
draw shown --clip 'x<12' --camera right;  quiet shown
draw glassy --clip 'x<12' --camera left --opacity .5; quiet glassy
draw corner --clip 'x<12' --clip 'y<10' --camera front; quiet corner
draw deep --clip camera:3 --camera back; quiet deep
draw away --slice x=900;                says away "--slice x=900 does not meet the volume"
draw edge --slice z=8 --opacity 0 --camera front; says edge "--slice z=8 is seen edge-on: --camera top looks at it"
draw level --slice z=8 --opacity 0 --camera top; quiet level
says level "slices show the values from 0 to 30000, which are all: --window"
draw auto --slice z=8 --opacity 0 --camera top --window auto; says auto "slices show the values from 1 to [0-9.]*$"
draw given --slice z=8 --opacity 0 --camera top --window 50,100
! grep -q "note: slices" given.said || exit 1
draw gray --clip 'x<12' --cap gray --camera right; says gray "--cap gray is one colour: --cap slice shows"
draw red --clip 'x<12' --cap red --camera right; quiet red
# a cap is seen where the note says, and not where it was said
cap() { draw "$1-red" --cap red "${@:2}" && draw "$1-blue" --cap blue "${@:2}" && isocompare images "$1-red.png" "$1-blue.png" --fail-under psnr=100 >/dev/null 2>&1; }
cap hidden-x --clip 'x<12' --camera left && cap hidden-y --clip 'keep:y<10' --camera front || exit 1
cap seen-x --clip 'x<12' --camera right && exit 1
cap seen-y --clip 'keep:y<10' --camera back && exit 1
python3 - <<'P'
import re
from check import *
least, most = map(float, re.search("from (\\S+) to (\\S+)$", open("auto.said").read(), re.M).groups())
expect(least == 1 and 90 < most < 120, (least, most))  # padding of 0 and the one voxel of 30,000 are left out
P
