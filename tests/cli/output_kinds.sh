# pictures as .tif and .jpg have the pixels, the texts and the resolution of the .png; --dpi is written into each.
python3 -c 'from check import *; ball("in/ball.mha")'
draw() { isorender in/ball.mha "$1" --resolution 90x70 --quiet "${@:2}"; }
draw a.png --dpi 300
draw a.tif --dpi 300
draw b.TIFF --background none --threads 1
draw b.png --background none
draw c.png
isorender in/ball.mha scaled.tif --resolution 50x50 --mm-per-pixel 0.25 --quiet
python3 - <<'P'
import struct, zlib
from check import *

def tiff(path):
    """The pixels of a picture as rows of RGBA tuples, and the tags."""
    data = open(path, "rb").read()
    magic, version, at = struct.unpack("<2sHI", data[:8])
    expect(magic == b"II" and version == 42, path)
    count, = struct.unpack("<H", data[at:at + 2])
    tags, last = {}, 0
    for i in range(count):
        number, kind, n, raw = struct.unpack("<HHI4s", data[at + 2 + 12 * i:at + 14 + 12 * i])
        expect(number > last, "the order of tags", number)
        last = number
        size = {2: 1, 3: 2, 4: 4, 5: 8}[kind] * n
        value = raw if size <= 4 else data[struct.unpack("<I", raw)[0]:][:size]
        tags[number] = (value[:n - 1].decode() if kind == 2 else
                        struct.unpack("<%d%s" % (n, "H" if kind == 3 else "I"), value[:size]) if kind < 5 else
                        struct.unpack("<2I", value[:8]))
    width, height, channels, rows = (tags[k][0] for k in (256, 257, 277, 278))
    raw = b"".join(zlib.decompress(data[o:o + n]) for o, n in zip(tags[273], tags[279]))
    expect(len(raw) == width * height * channels and tags[259] == (8,) and tags[317] == (2,), tags)
    pixels = []
    for y in range(height):
        now = [0] * channels
        for x in range(width):
            base = (y * width + x) * channels
            now = [(a + b) & 255 for a, b in zip(now, raw[base:base + channels])]
            pixels.append(tuple(now) if channels == 4 else (*now, 255))
    return pixels, tags

pixels, tags = tiff("a.tif")
expect(pixels == list(Png("a.png").pixels()) == list(Png("c.png").pixels()), "opaque")
expect(tags[282][0] / tags[282][1] == 118.11 and tags[296] == (3,) and "isorender" in tags[305] and "ball" in tags[269], tags)
pixels, tags = tiff("b.TIFF")
expect(pixels == list(Png("b.png").pixels()) and tags[277] == (4,) and tags[338] == (2,) and 282 not in tags, tags)
tags = tiff("scaled.tif")[1]
expect(tags[282][0] / tags[282][1] == 40, tags)  # pixels a centimetre
data = open("a.png", "rb").read()
at = data.index(b"pHYs")
expect(struct.unpack(">IIB", data[at + 4:at + 13]) == (11811, 11811, 1), "pHYs")
expect(b"pHYs" not in open("c.png", "rb").read(), "no resolution is invented")
P
refuses 2 'bad.jpg: a JPEG has no transparency' isorender in/ball.mha -o bad.jpg --background none
if isorender in/ball.mha a.jpg --resolution 90x70 --dpi 300 --quiet 2>error.txt; then
    python3 - <<'P'
import struct
from check import *
data = open("a.jpg", "rb").read()
expect(data[:4] == b"\xff\xd8\xff\xe0" and data[6:11] == b"JFIF\0" and data[-2:] == b"\xff\xd9", data[:20])
expect(struct.unpack(">BHH", data[13:18]) == (1, 300, 300), data[:20])
frame = data.index(b"\xff\xc0")
expect(struct.unpack(">HH", data[frame + 5:frame + 9]) == (70, 90) and b"Software: isorender" in data, "size, comment")
P
    isorender in/ball.mha b.JPEG --resolution 90x70 --dpi 300 --quiet --threads 1
    cmp -i 700 a.jpg b.JPEG # behind the comment with the command
else
    [ $? -eq 4 ] || grep -q 'built without libjpeg' error.txt
fi
# the parts of a picture become any kind
isorender in/ball.mha --part 1/2 -o 1.isokeys --resolution 90x70 --dpi 300 --fit tight --quiet
isorender in/ball.mha --part 2/2 -o 2.isokeys --resolution 90x70 --dpi 300 --fit tight --quiet
isorender merge 1.isokeys 2.isokeys -o merged.tif --quiet
python3 -c 'a, b = (open(n, "rb").read() for n in ("a.tif", "merged.tif")); assert a[8:2000] == b[8:2000]'
# a patient from the top has its front at the picture's top; another volume is a map
python3 -c '
from check import *
ball("in/patient.mha", header="TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nAnatomicalOrientation = RAI\n")'
isorender in/patient.mha --camera top p.png --resolution 20x20 --quiet --json=p.json
isorender scene:torus:32 --camera top t.png --resolution 20x20 --quiet --json=t.json
python3 - <<'P'
from check import *
p, t = report("p.json"), report("t.json")
expect(p["volume"]["anatomical"] and p["camera"]["view_up"] == [0, -1, 0], p["camera"])
expect(t["camera"]["view_up"] == [0, 1, 0], t["camera"])
P
