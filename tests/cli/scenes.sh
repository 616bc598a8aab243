# A scene is a picture as data. --save-scene writes input and options as JSON, and every PNG holds them. Both draw the same bytes again, also from
# other folders, and with changes; other files, damage, and options that do not belong to a picture are refused.
python3 - <<'P'
from check import *
ball("in/a.mha", radius=8.0)
ball("in/b.mha", radius=5.0)
P
printf '1 2 3\n4 5 6\n' >in/p.xyz
ring="--glyphs in/p.xyz --glyph-radius 2 --glyph-color ff0000"
isorender in/a.mha first.png --isovalue 500 --isovalue 300 --opacity 1 --opacity 0.4 $ring --resolution 80x60 --azimuth 20 \
    --orthographic --scale-bar --save-scene fig.json --quiet
isorender fig.json --quiet
cmp first.png fig.png
isorender --again first.png -o second.png --quiet
cmp first.png second.png
# from another folder, and saved into one
mkdir deep saved
(cd deep && isorender ../fig.json third.png --quiet && isorender --again=../first.png fourth.png --quiet)
cmp first.png deep/third.png
cmp first.png deep/fourth.png
isorender fig.json saved/fig.png --save-scene saved/fig.json --quiet
isorender saved/fig.json fifth.png --quiet
python3 - <<'P'
from check import *
a, b = Png("first.png"), Png("fifth.png")
expect(a.rows == b.rows)
scene = json.loads(a.texts["Scene"])
expect(scene["input"] == "in/a.mha" and {"azimuth": "20"} in scene["options"] and {"scale-bar": True} in scene["options"], scene)
whole = report("fig.json")
expect(whole["scene"] == 1 and whole["isovalues"] == [500, 300] and whole["camera"]["view_angle"] == 30, whole)
expect([f["path"] for f in whole["files"]] == ["in/a.mha", "in/p.xyz"], whole)
P
# a PNG has no absolute path
isorender "$PWD/in/a.mha" absolute.png --resolution 80x60 --quiet
! grep -qa "$PWD" absolute.png
# changes: an option, another input (whatever it holds), several scenes
isorender fig.json small.png --resolution 40x30 --quiet
isorender fig.json in/b.mha other.png --quiet
python3 - <<'P'
from check import *
expect(Png("small.png").width == 40)
expect(Png("other.png").rows != Png("first.png").rows)
P
# an option replaces all of its kind that the picture had, and files that only these named need not be there
isorender --again first.png one.png --isovalue 450,350 --quiet --json=one.json
isorender --again first.png red.png --color red --opacity 1 --quiet
python3 - <<'P'
from check import *
expect(report("one.json")["isovalues"] == [450, 350], report("one.json")["isovalues"])
scene = json.loads(Png("red.png").texts["Scene"])
given = [next(iter(o.items())) for o in scene["options"]]
expect([v for k, v in given if k == "opacity"] == ["1"] and [v for k, v in given if k == "color"] == ["red"], given)
P
mkdir away && cp first.png away/ && cp in/p.xyz elsewhere.xyz
refuses 3 "away/in/p.xyz: cannot read" isorender --again away/first.png in/a.mha -o bad.png --quiet
(cd away && isorender --again first.png ../in/a.mha --glyphs ../elsewhere.xyz -o moved.png --quiet)
python3 -c 'from check import *; expect(Png("away/moved.png").rows == Png("first.png").rows)'
cp fig.json two.json
isorender fig.json two.json --quiet
cmp fig.png two.png
# several pictures again: none overwrites another's, and {n} counts them, with their inputs
isorender --again small.png --again other.png -o 'again-{n}.png' --quiet
cmp small.png again-0.png
cmp other.png again-1.png
isorender fig.json two.json in/a.mha in/b.mha -o 'both-{n}.png' --quiet
cmp first.png both-0.png
cmp other.png both-1.png
cmp first.png both-2.png
cmp other.png both-3.png
refuses 2 "again.png: two outputs have this name; several scenes need a template, such as --output 'figure-{n}.png'" \
    isorender --again small.png --again other.png again.png
refuses 2 "a.png: two outputs have this name" isorender --again first.png --again small.png
refuses 2 "x.json: two outputs have this name" isorender fig.json two.json --json=x.json
! ls again.png a.png x.json 2>/dev/null
# the schema has every option of a scene, and none of the others
isorender --schema >schema
python3 - <<'P'
from check import *
names = report("schema")["properties"]["options"]["items"]["properties"]
expect("isovalue" in names and "azimuth" in names and "output" not in names and "threads" not in names, sorted(names))
P
# refusals
refuses 2 "overwrite the input first.png" isorender --again first.png first.png
python3 - <<'P'
import struct, zlib
def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
with open("plain.png", "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) +
               chunk(b"IDAT", zlib.compress(bytes(4))) + chunk(b"IEND", b""))
P
isorender_refuses 3 'no text "Scene"' --again plain.png
head -c 300 first.png >cut.png
isorender_refuses 3 "cut.png: PNG file ends too early" --again cut.png
echo '{"scene": 1, "options": [{"output": "x.png"}]}' >in/s.json
isorender_refuses 3 "'output' does not belong to a scene" in/s.json
echo '{"scene": 1, "options": [{"isovalues": "1"}]}' >in/s.json
isorender_refuses 3 "there is no option 'isovalues'" in/s.json
echo '{"scene": 2, "options": []}' >in/s.json
isorender_refuses 3 "a scene of another version" in/s.json
echo '{"scene": 1, "options": [{"isovalue": [1]}]}' >in/s.json
isorender_refuses 3 "the value of 'isovalue'" in/s.json
echo '{"scene": 1, "options": [], "input": "--mesh=bad.ply"}' >in/s.json # an input is never an option
isorender_refuses 3 "in/--mesh=bad.ply: cannot read" in/s.json
(cd in && refuses 3 "[.]/--mesh=bad.ply: cannot read" isorender s.json --quiet)
echo '{"scene": 1, "options": [], "input": "merge"}' >in/s.json
(cd in && refuses 3 "[.]/merge: cannot read" isorender s.json --quiet)
echo '{"scene": 1' >in/s.json
isorender_refuses 3 "s.json: line" in/s.json
echo '{"a": 1}' >in/s.json
isorender_refuses 3 "holds no scene" --again in/s.json
cp in/b.mha in/a.mha
isorender_refuses 3 "in/a.mha is not the file that it was drawn from" fig.json
