# A stack of TIFF images that is cut anywhere, or whose headers lead elsewhere, is refused or gives the same picture: a part of the
# slices does not pass for the whole. Many images cost what their number costs, not its square. An image in one piece
# that is larger than the limit of memory is refused before it is unpacked.
python3 - <<'P'
import os, resource, subprocess, zlib
from check import *
from tiff_files import tiff

side = 20
planes = [bytes(max(0, int(255 - 20 * ((x - 9) ** 2 + (y - 9) ** 2 + (z - 9) ** 2) ** 0.5)) for y in range(side) for x in range(side))
          for z in range(side)]
text = "ImageJ=1.53t\nimages=20\nslices=20\nunit=mm\nspacing=1.5\n"


def draw(path):
    done = subprocess.run(["isorender", path, "cut.png", "--isovalue", "120", "--resolution", "32x32", "--json=cut.json"],
                          capture_output=True, text=True, timeout=20)
    picture = open("cut.png", "rb").read() if done.returncode == 0 else None
    for name in "cut.png", "cut.json":
        os.path.exists(name) and os.remove(name)
    return done, picture


def refused(path, *words):
    done, _ = draw(path)
    lines = done.stderr.splitlines()
    expect(done.returncode == 3 and len(lines) == 1 and lines[0].startswith("isorender: " + path), path, done)
    expect(all(word in lines[0] for word in words), words, lines)


# Every twentieth, and the end of every header.
for headers in "behind", "last":
    for pack in None, zlib.compress:
        places = tiff("in/whole.tif", (side, side), planes, description=text, headers=headers, pack=pack)
        whole = open("in/whole.tif", "rb").read()
        done, picture = draw("in/whole.tif")
        expect(done.returncode == 0, done)
        for length in sorted({len(whole) * part // 20 for part in range(1, 20)} |
                             {place + more for place in places[::5] for more in (0, 2, 134)}):
            open("in/cut.tif", "wb").write(whole[:length])
            done, part = draw("in/cut.tif")
            same = done.returncode == 0 and part == picture
            expect(same or done.returncode == 3 and len(done.stderr.splitlines()) == 1 and "in/cut.tif" in done.stderr, length, done)

# The text behind the last header of a single image is cut off: its distances would be lost.
tiff("in/one.tif", (side, side), planes[:1], description=text)
data = open("in/one.tif", "rb").read()
open("in/one.tif", "wb").write(data[:-20])
refused("in/one.tif", "image 1", "truncated")

# A next header behind the end of the file, at an earlier header, at itself, within the pixels.
places = tiff("in/whole.tif", (side, side), planes)
for number, target in (9, len(whole) + 5000), (9, places[3]), (9, places[9]), (0, places[0]), (19, places[0]), (9, 8):
    wrong = bytearray(open("in/whole.tif", "rb").read())
    struct.pack_into("<I", wrong, places[number] + 2 + 12 * 10, target)
    open("in/wrong.tif", "wb").write(wrong)
    refused("in/wrong.tif", "truncated or damaged")

# Each of 20,000 images is found at once: 1 s of processor time, and a minute where all headers before it are read.
tiff("in/many.tif", (2, 2), [bytes([z % 251] * 4) for z in range(20000)])
before = resource.getrusage(resource.RUSAGE_CHILDREN)
done = subprocess.run(["isorender", "in/many.tif", "--info", "--threads", "1", "--json=many.json"], capture_output=True, text=True)
after = resource.getrusage(resource.RUSAGE_CHILDREN)
expect(done.returncode == 0 and report("many.json")["volume"]["dims"] == [2, 2, 20000], done)
expect(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 12, "20,000 images take too long", before, after)

# 150 MB in one strip, under a limit of 64 MB. (One image is a volume of one slice.)
tiff("in/strip.tif", (15000, 10000), [bytes(150000000)], pack=lambda data: zlib.compress(data, 1))
done = subprocess.run(["isorender", "in/strip.tif", "strip.png", "--isovalue", "1", "--max-memory", "64M"], capture_output=True, text=True)
expect(done.returncode == 5 and len(done.stderr.splitlines()) == 1 and "in/strip.tif" in done.stderr, done)
P
