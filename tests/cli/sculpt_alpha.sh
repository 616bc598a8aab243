# pictures of heights in stroke files: they weigh what brushes do, by any number of threads, and can be turned or left out by edits;
# what is damaged is refused in one line
cat > make.py <<'P'
import base64

import strokes as s
from check import crc32c

def picture(values, width, height, **changes):
    text = base64.b64encode(b"".join(v.to_bytes(2, "little") for v in values)).decode()
    return {"event": "stamp", "name": "heights.png", "heights": text, "size": [width, height], "checksum": crc32c(text.encode()), **changes}

def stroke(points, **brush):
    at = lambda x: {"at": [x, -20.0, 11.0], "normal": [0.0, -0.88, 0.48]}
    return [s.begin(at(points[0]), **brush), *(s.sample(**at(x)) for x in points[1:]), {"event": "end"}]

white, half = [65535] * 64, [65535 * (i % 8 < 4) for i in range(64)]
head = s.header(voxel_size=0.5, dims=[128, 128, 128], origin=[-31.75] * 3, radius=23.0)
inflate = dict(tool="inflate", falloff="constant", radius=5.0)
path = [0.0, 0.5, 1.0, 1.5]
s.write("ball.strokes", [], head)
s.write("plain.strokes", stroke(path, **inflate), head)
s.write("white.strokes", [picture(white, 8, 8)] + stroke(path, alpha="fixed", **inflate), head)
s.write("fixed.strokes", [picture(half, 8, 8)] + stroke(path, alpha="fixed", **inflate), head)
s.write("follows.strokes", [picture(half, 8, 8)] + stroke(path, alpha="follows", **inflate), head)
for name, change in {"checksum": {"checksum": 1}, "size": {"size": [8, 7]}, "wide": {"size": [257, 1]}, "text": {"heights": "A*=="}}.items():
    s.write(name + ".bad", [picture(half, 8, 8, **change)], head)
s.write("none.bad", stroke(path, alpha="fixed", **inflate), head)
s.write("name.bad", [picture(half, 8, 8)] + stroke(path, alpha="up", **inflate), head)
P
python3 make.py
play() { isosculpt --replay "$1.strokes" --headless --mesh "$2.ply" --json="$2.json" --quiet "${@:3}"; }
for name in ball plain white fixed follows; do play $name $name; done
play fixed one --threads 1
cmp fixed.ply one.ply
play fixed turned --edit 1:alpha=follows --save-strokes turned.strokes
cmp turned.ply follows.ply
play turned again
cmp again.ply follows.ply
play fixed without --edit 1:alpha=none
cmp without.ply plain.ply
! cmp -s fixed.ply follows.ply
python3 - <<'P'
from check import *
volume = {name: report(name + ".json")["mesh"]["volume"] for name in ("ball", "plain", "white", "fixed", "follows")}
volume = {name: v - volume["ball"] for name, v in volume.items()}
expect(volume["plain"] > 20, volume)
expect(0.9 < volume["white"] / volume["plain"] < 1, volume)  # (the borders of a picture are soft)
expect(0.4 < volume["fixed"] / volume["white"] < 0.6, volume)
P
for bad in *.bad; do
    cp "$bad" bad.strokes
    code=0
    isosculpt --replay bad.strokes --headless --mesh bad.ply --quiet 2>message || code=$?
    [ "$code" = 3 ] && [ "$(wc -l <message)" = 1 ] && grep -q "bad.strokes' line [0-9]*: " message && [ ! -e bad.ply ] ||
        { echo "$bad: $code"; cat message; exit 1; }
done
