# Steps in time: one framing, one isovalue and one range of colours for all; what a step shows is what isorender draws of it alone.
python3 - <<'P'
from check import *
import struct
def blob(t):
    return lambda x, y, z: 0.0 if t == 3 else max(0.0, 4 + t - ((x - 6 - t) ** 2 + (y - 10) ** 2 + (z - 10) ** 2) ** 0.5)
for t in (1, 2, 3, 10):
    volume("in/t_%d.mha" % t, (24, 20, 20), blob(t))
volume("in/heat.mha", (24, 20, 20), lambda x, y, z: float(x))
volume("in/other.mha", (24, 20, 20), lambda x, y, z: 0.0)
# the same steps as one 4-D file
head = bytearray(nifti_header((24, 20, 20), 16, 32))
struct.pack_into("<8h", head, 40, 4, 24, 20, 20, 4, 1, 1, 1)
struct.pack_into("<f", head, 108, 352.0)
head[344:348] = b"n+1\0"
with open("in/t.nii", "wb") as file:
    file.write(bytes(head) + bytes(4))
    for t in (1, 2, 3, 10):
        file.write(struct.pack("<9600f", *[blob(t)(x, y, z) for z in range(20) for y in range(20) for x in range(24)]))
# and as channel 1 of an OME-Zarr with two
import json, os
os.mkdir("in/t.zarr")
os.mkdir("in/t.zarr/0")
axes = [{"name": n, "type": k} for n, k in zip("tczyx", ("time", "channel", "space", "space", "space"))]
json.dump({"zarr_format": 2}, open("in/t.zarr/.zgroup", "w"))
json.dump({"multiscales": [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": [
    {"type": "scale", "scale": [1, 1, 1, 1, 1]}]}]}],
    "omero": {"channels": [{"label": "a", "color": "FF0000"}, {"label": "b", "color": "00FF00"}]}}, open("in/t.zarr/.zattrs", "w"))
json.dump({"zarr_format": 2, "shape": [4, 2, 20, 20, 24], "chunks": [1, 1, 20, 20, 24], "dtype": "<f4", "compressor": None,
           "fill_value": 0, "order": "C", "filters": None}, open("in/t.zarr/0/.zarray", "w"))
for i, t in enumerate((1, 2, 3, 10)):
    for c in (0, 1):
        with open("in/t.zarr/0/%d.%d.0.0.0" % (i, c), "wb") as file:
            file.write(struct.pack("<9600f", *[blob(t)(x, y, z) if c else 7.0 for z in range(20) for y in range(20) for x in range(24)]))
P
small="--resolution 60x50 --quiet"
place="--camera-position 12,-60,30 --camera-focal-point 12,10,10"
cat >in/reports.py <<'P'
import json
def reports(path):
    text = open(path).read().strip()
    while text:
        value, end = json.JSONDecoder().raw_decode(text)
        text = text[end:].strip()
        yield value
P
export PYTHONPATH=$PYTHONPATH:$PWD/in
hashes() { python3 -c 'from reports import *; [print(r["image"]["hash"] if "image" in r else "none") for r in reports("'$1'")]'; }
# in the order of the numbers; the step without a surface shows the background
isorender --series-of 'in/t_*.mha' out.png --isovalue 2 $place $small --json >all
[ "$(ls out_*.png | tr '\n' ' ')" = "out_000.png out_001.png out_002.png out_003.png " ]
for t in 1 2 10; do isorender in/t_$t.mha one.png --isovalue 2 $place $small --json; done >each
hashes all | grep -v none | cmp - <(hashes each)
python3 -c 'from check import *; p = Png("out_002.png"); expect(all(q == (255, 255, 255, 255) for row in p.rows for q in row), "not empty")'
# the components of one file are the same pictures (its axes are other ones: no frame of the file is the other's)
isorender --series-of in/t.nii four.png --isovalue 2 $small --json >four
isorender in/t.nii two.png --component 1 --isovalue 2 $place $small --json=two.json
isorender --series-of in/t.nii four.png --isovalue 2 $place $small --json >four
[ "$(hashes four | sed -n 2p)" = "$(python3 -c 'import json; print(json.load(open("two.json"))["image"]["hash"])')" ]
[ "$(hashes four | sort -u | wc -l)" = 4 ]
# of a file with channels the times of the one that is chosen
isorender in/t.zarr where.png --component 7 --isovalue 2 $small --json=where.json
at="--camera-view-up 0,0,1 $(python3 -c 'from check import *; c = report("where.json")["camera"]; print(*["--camera-%s %g,%g,%g" % (n, *c[k]) for n, k in (("position", "position"), ("focal-point", "focal_point"))])')"
isorender --series-of in/t.zarr z.png --component 1 --isovalue 2 $at $small --json >zarr
[ "$(ls z_*.png | wc -l)" = 4 ]
for i in 1 3 7; do isorender in/t.zarr one.png --component $i --isovalue 2 $at $small --json; done >times
hashes zarr | grep -v none | cmp - <(hashes times)
[ "$(hashes times | sort -u | wc -l)" = 3 ]
# the isovalue of the first, and the camera of all: the box of all steps is framed, so each is in the picture
isorender --series-of 'in/t_*.mha' auto.png $small --orthographic --json >auto
python3 - <<'P'
import json
from check import *
from reports import *
steps = list(reports("auto"))
expect(len({s["isovalue"] for s in steps if s.get("isovalue") is not None}) == 1, "isovalues")
expect(len({json.dumps(s["camera"]) for s in steps}) == 1, "cameras")
columns, rows = set(), set()
for i in range(4):
    p = Png("auto_%03d.png" % i)
    for y, row in enumerate(p.rows):
        for x, q in enumerate(row):
            if q[:3] != (255, 255, 255):
                columns.add(x), rows.add(y)
expect(min(columns) > 0 and max(columns) < 59 and min(rows) > 0 and max(rows) < 49, "out of the frame")
expect(max(max(columns) - min(columns), max(rows) - min(rows)) > 40, "framed too widely")
P
# one range of colours: from the lowest to the highest of all
isorender --series-of 'in/t_*.mha' heat.png --isovalue 2 --surface-color-by in/heat.mha $small --json >heat
for t in 1 2 10; do isorender in/t_$t.mha one.png --isovalue 2 --surface-color-by in/heat.mha $small --json; done >each
python3 - <<'P'
from check import *
from reports import *
ranges = [r["surface_colors"][0]["range"] for r in reports("heat") if "surface_colors" in r]
each = [r["surface_colors"][0]["range"] for r in reports("each")]
whole = [min(r[0] for r in each), max(r[1] for r in each)]
steps = [ranges[i] for i in (0, 1, len(ranges) - 1)]
expect(all(r == whole for r in steps), ranges, whole)
P
# a turntable turns while time goes on
isorender --series-of 'in/t_*.mha' turn.png --isovalue 2 --turntable 4 $place $small --json >turn
isorender in/t_2.mha one.png --isovalue 2 $place --azimuth 90 $small --json >each
[ "$(hashes turn | sed -n 2p)" = "$(hashes each)" ]
# without a name each has its file's; mpirun and parts draw one picture
isorender --series-of 'in/t_*.mha' --isovalue 2 $small
[ -f t_1.png ] && [ -f t_10.png ]
isorender_refuses 2 "one step is no series" --series-of in/t_2.mha
isorender_refuses 3 "no file is called so" --series-of 'in/u_*.mha'
isorender_refuses 6 "nothing\|constant\|no surface" --series-of 'in/t_[13].mha' --isovalue 1000
refuses 2 "takes no other input" isorender in/heat.mha --series-of 'in/t_*.mha' -o bad.png
refuses 2 "cannot be combined with --series-of" isorender --series-of 'in/t_*.mha' --part 1/2
# a step that cannot be read ends it
head -c 500 in/t_2.mha >in/t_4.mha
isorender_refuses 3 "t_4.mha" --series-of 'in/t_*.mha' --isovalue 2
rm in/t_4.mha
# a scene keeps it
isorender --series-of 'in/t_*.mha' s.png --isovalue 2 $place $small --save-scene '{model}.json'
isorender t_1.json -o again.png $small
cmp again_003.png out_003.png || isocompare images again_003.png out_003.png --quiet --fail-under psnr=200
command -v ffmpeg >/dev/null || exit 0
isorender --series-of 'in/t_*.mha' film.apng --isovalue 2 $place $small
ffmpeg -v error -i film.apng -pix_fmt rgb24 -f framemd5 - | grep -v '^#' | sed 's/.*, //' >film
ffmpeg -v error -i out_%03d.png -pix_fmt rgb24 -f framemd5 - | grep -v '^#' | sed 's/.*, //' | cmp - film
