# --panels and --panel-file: each panel has the bytes of the picture that the command makes with this option alone, all have one framing,
# isovalue and range of colours; letters and titles; the page is drawn again from itself, also from its scene.
python3 - <<'P'
from check import *
ball("in/a.mha", side=32, radius=8.0)
ball("in/b.mha", side=32, radius=5.0)
P
size="--resolution 120x100"
eye="--camera-position 0,-40,30 --camera-focal-point 15.5,15.5,15.5"
isorender in/a.mha methods.png $size --isovalue 500 --panels method=exact,mesh,raycast $eye --quiet --save-scene methods.json
isorender in/a.mha methods1.png $size --isovalue 500 --panels method=exact,mesh,raycast $eye --quiet --threads 1
for method in exact mesh raycast; do isorender in/a.mha $method.png $size --isovalue 500 --method $method $eye --quiet; done
isorender --again methods.png -o again.png --quiet
cmp methods.png methods1.png
cmp methods.png again.png
(mkdir deep && cd deep && isorender ../methods.json scene.png --quiet)
cmp methods.png deep/scene.png
# one framing: that of the largest; the colours' range holds those of both
isorender in/a.mha values.png $size --panels isovalue=200,500,800 --panel-columns 2 --quiet
isorender in/a.mha value.png $size --isovalue 200 --quiet
isorender in/b.mha files.png $size --isovalue 500 --panel-file in/a.mha --surface-color-by depth --color-bar --panel-titles 'before;after, later' --quiet
isorender --again files.png -o files2.png --quiet
cmp files.png files2.png
isorender in/a.mha views.svg $size --isovalue 500 --panels camera=front,left,top --orthographic --scale-bar --legend=Ball --quiet
isorender in/a.mha clips.png $size --isovalue 500 --panels 'clip=x<15;keep:sphere:16,16,16,6' --cap slice --quiet
isorender in/a.mha page.pdf $size --isovalue 500 --panels azimuth=0,45 --quiet
python3 - <<'P'
from check import *
import xml.dom.minidom
def panel(png, column, row, margin, band):
    left, top = margin + column * (120 + margin), band + row * (100 + band)
    return [line[left:left + 120] for line in png.rows[top:top + 100]]
margin, band = 8, 19 # of letters whose capitals are 9 pixels high
page = Png("methods.png")
expect((page.width, page.height) == (3 * 128 + 8, 119 + 8), page.width, page.height)
for i, name in enumerate(("exact", "mesh", "raycast")):
    expect(panel(page, i, 0, margin, band) == Png(name + ".png").rows, name)
ink = [x for x in range(page.width) for y in range(band) if page.rows[y][x][0] < 100]
expect({x // 128 for x in ink} == {0, 1, 2}, "letters")
values = Png("values.png")
expect((values.width, values.height) == (2 * 128 + 8, 2 * 119 + 8))
expect(panel(values, 0, 0, margin, band) == Png("value.png").rows)
count = [sum(p[:3] != (255, 255, 255) for row in panel(values, i % 2, i // 2, margin, band) for p in row) for i in range(3)]
expect(count[0] > 1.3 * count[1] > 1.69 * count[2] > 0, count)
files = Png("files.png")
expect(files.width > 2 * 128 + 8 + 30, "the colour bar stands beside", files.width)
count = [sum(p[:3] != (255, 255, 255) for row in panel(files, i, 0, margin, band) for p in row) for i in range(2)]
expect(2 < count[1] / count[0] < 3.2, count) # (8/5)^2: one framing
views = xml.dom.minidom.parse("views.svg").documentElement
texts = [t.firstChild.data for t in views.getElementsByTagName("text")]
expect(texts[:1] != [] and [t for t in texts if t in ("a", "b", "c")] == ["a", "b", "c"] and {"front", "left", "top", "Ball"} <= set(texts), texts)
expect(len({t for t in texts if t.endswith(" mm")}) == 1, texts)
P
refuses 2 "is not WHAT=A,B" isorender in/a.mha bad.png --panels beauty=1,2 || exit 1
refuses 2 "--panel-file names each" isorender in/a.mha bad.png --panels file=in/b.mha || exit 1
refuses 2 "no value between two ','" isorender in/a.mha bad.png --panels isovalue=1,,2 || exit 1
refuses 2 "does not make pictures that differ" isorender in/a.mha bad.png --panels threads=1,2 || exit 1
refuses 2 "2 titles for 3 panels" isorender in/a.mha bad.png --panels isovalue=100,200,300 --panel-titles a,b || exit 1
refuses 2 "panel b (camera sideways): option --camera: 'sideways' is not one of\|panel b (sideways): option --camera: 'sideways' is not one of" isorender in/a.mha bad.png --panels camera=front,sideways || exit 1
refuses 2 "cannot be combined with --mesh" isorender in/a.mha bad.png --panels azimuth=1,2 --mesh bad.stl || exit 1
refuses 2 "is for --panels" isorender in/a.mha bad.png --panel-columns 2 || exit 1
refuses 3 "panel b (missing): in/missing.mha" isorender in/a.mha bad.png --panel-file in/missing.mha --isovalue 500 || exit 1
refuses 6 "panel b (isovalue 5000): in/a.mha: no surface" isorender in/a.mha bad.png --panels isovalue=500,5000 || exit 1
refuses 5 "at most 16384 a side\|--max-memory" isorender in/a.mha bad.png --panels isovalue=100,200 --resolution 16000x16000 || exit 1
rm -f said
# a volume that several panels show is read once, whatever they do with its surface
python3 - <<'P'
import os, subprocess
from check import *
ball("in/large.mha", side=128, radius=40.0)
def read_by(*options):
    """Bytes that a run reads."""
    count = lambda: int(next(line for line in open("/proc/self/io") if line.startswith("rchar")).split()[1])
    before = count()
    subprocess.run(["isorender", *options, "--quiet", "--resolution", "60x50"], check=True)
    return count() - before
size = os.path.getsize("in/large.mha")
one = read_by("in/large.mha", "one.png", "--isovalue", "500")
many = read_by("in/large.mha", "many.png", "--panels", "isovalue=200,500,800")
changed = read_by("in/large.mha", "changed.png", "--panels", "isovalue=200,500", "--largest=1")
expect(one > size, one, size)
expect(many < one + 0.5 * size and changed < one + 4 * size, many, changed, one, size)
P
isorender in/large.mha part200.png --isovalue 200 --largest=1 --resolution 120x100 $eye --quiet
isorender in/large.mha part500.png --isovalue 500 --largest=1 --resolution 120x100 $eye --quiet
isorender in/large.mha parts.png --panels isovalue=200,500 --largest=1 --resolution 120x100 $eye --quiet
python3 - <<'P'
from check import *
parts = Png("parts.png")
for i, value in enumerate((200, 500)):
    left = 8 + 128 * i
    expect([line[left:left + 120] for line in parts.rows[19:119]] == Png("part%d.png" % value).rows, value)
P
# Two options that differ together: each panel is the picture with its value of both.
isorender in/large.mha both.png --panels isovalue=200,500 --panels color=red,gold --resolution 120x100 $eye --quiet
isorender in/large.mha both0.png --isovalue 200 --color red --resolution 120x100 $eye --quiet
isorender in/large.mha both1.png --isovalue 500 --color gold --resolution 120x100 $eye --quiet
python3 - <<'P'
from check import *
both = Png("both.png")
for i in range(2):
    left = 8 + 128 * i
    expect([line[left:left + 120] for line in both.rows[19:119]] == Png("both%d.png" % i).rows, i)
P
refuses 2 "option --panels: 3 values of color for 2 panels" isorender in/large.mha bad.png --panels isovalue=200,500 --panels color=red,gold,blue || exit 1
