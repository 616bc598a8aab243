# A folder of JPEG files is a volume: the values that djpeg decodes, of greys and colours, also of progressive files. Files that are
# cut, damaged, no JPEG or unequal are refused by name.
command -v cjpeg >/dev/null || { echo "skipped: libjpeg-turbo-progs makes the JPEG files" && exit 77; }
if isorender scene:sphere:16 in/try.jpg --quiet 2>&1 | grep -q "built without"; then echo "skipped: built without libjpeg"; exit 77; fi
python3 - <<'P'
import os, subprocess
from check import *
from png_files import png_file

SIDE, COUNT = 37, 19 # no whole number of JPEG's blocks


def ball(x, y, z):
    return max(0, 255 - int(12 * ((x - 18) ** 2 + (y - 18) ** 2 + (2 * z - 18) ** 2) ** 0.5))


def run(*command, **more):
    return subprocess.run(command, capture_output=True, timeout=60, **{"text": True, **more})


def jpeg(path, rows, channels, *options):
    """Writes a JPEG file, and returns the bytes that djpeg makes of it."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    head = b"P%d %d %d 255\n" % (5 if channels == 1 else 6, SIDE, SIDE)
    done = run("cjpeg", "-quality", "90", "-outfile", path, *options, input=head + b"".join(rows), text=False)
    expect(done.returncode == 0, done)
    return run("djpeg", "-pnm", path, text=False).stdout[-SIDE * SIDE * channels:]


decoded = []
for z in range(COUNT):
    rows = [bytes(ball(x, y, z) for x in range(SIDE)) for y in range(SIDE)]
    decoded.append(jpeg("in/jpeg/s%d.jpg" % z, rows, 1))
    expect(jpeg("in/progressive/s%d.jpeg" % z, rows, 1, "-progressive") == decoded[z], z)
colours = [jpeg("in/colour/%d.JPEG" % z, [bytes(c for x in range(SIDE) for c in (5 * x, 200 - 30 * z, 6 * y))
                                          for y in range(SIDE)], 3) for z in range(3)]


def info(path, *options):
    done = run("isorender", path, "--info", "--json=o.json", *options)
    expect(done.returncode == 0, done)
    return report("o.json")


volume = info("in/jpeg")["volume"]
expect(volume["format"] == "jpeg" and volume["dims"] == [SIDE, SIDE, COUNT] and volume["type"] == "uint8", volume)
expect(any("JPEG does not keep values" in note for note in volume["notes"]), volume)
def check(path, z, values, *options):
    """The range of the slice, and of its middle row."""
    for rows in (0, SIDE - 1), (18, 18):
        found = info(path, "--crop", "0,%d,%d,%d,%d,%d" % (SIDE - 1, *rows, z, z), *options)["value_range"]
        wanted = values[rows[0] * SIDE:(rows[1] + 1) * SIDE]
        expect(found == [min(wanted), max(wanted)], path, z, rows, found, min(wanted), max(wanted))


for z in range(COUNT): # the order of the slices, and their values
    for path in "in/jpeg", "in/progressive":
        check(path, z, decoded[z])
for component in range(3):
    for z in range(3):
        check("in/colour", z, colours[z][component::3], "--component", str(component))

# The same picture with several threads and in little memory.
pictures = []
for path, options in ("in/jpeg", ["--threads", "1"]), ("in/progressive", ["--threads", "3"]), ("in/jpeg", ["--chunk-size", "16"]):
    done = run("isorender", path, "p.png", "--isovalue", "120", "--spacing", "1,1,2", "--resolution", "48x48", "--fit", "box", *options)
    expect(done.returncode == 0, done)
    pictures.append(Png("p.png").rows)
expect(pictures[0] == pictures[1] == pictures[2], "pictures differ")
expect(len({p for row in pictures[0] for p in row}) > 8, "nothing is seen")


def refused(data, *words, status=3):
    for z in range(3):
        os.makedirs("in/bad", exist_ok=True)
        open("in/bad/%d.jpg" % z, "wb").write(data if z == 1 else good)
    done = run("isorender", "in/bad", "out.png", "--isovalue", "120", "--resolution", "16x16")
    lines = done.stderr.splitlines()
    expect(done.returncode == status and len(lines) == 1 and lines[0].startswith("isorender: in/bad/1.jpg: "), done)
    expect(all(word in lines[0] for word in words) and not os.path.exists("out.png"), words, lines)


good = open("in/jpeg/s9.jpg", "rb").read()
scan = good.index(b"\xff\xda") + 2
for at in sorted({*range(0, len(good) - 2, 13), len(good) - 3}):
    refused(good[:at], "truncated")
refused(good[:scan + 40] + b"\xff\xd9", "in/bad/1.jpg") # the picture ends before its last row
frame = good.index(b"\xff\xc0")
refused(good[:frame + 4] + b"\x0c" + good[frame + 5:], "precision 12")
refused(open("in/colour/0.JPEG", "rb").read(), "3 sample(s)", "(in/bad/0.jpg) is 37 x 37 uint8 with 1")
refused(png_file((SIDE, SIDE), [bytes(SIDE)] * SIDE), "damaged, or no JPEG file")
done = run("isorender", "in/jpeg/s9.jpg", "out.png")
expect(done.returncode == 3 and "is one picture: a volume in JPEG is a folder" in done.stderr, done)
P
