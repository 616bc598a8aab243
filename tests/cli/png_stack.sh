# A folder of PNG files is a volume, whose slices are in the natural order of their names: greys of every depth, palettes of greys,
# interlaced files, colours as components. Slices that do not fit together, palettes of colours, and files that are cut, damaged,
# no PNG or no regular files are refused by name. Pictures beside DICOM images are no slices.
python3 - <<'P'
import os, struct, subprocess
from check import *
from dicom_slices import slice_of
from png_files import interlaced_rows, png_chunk, png_file

WIDTH, HEIGHT = SIZE = 10, 9
NAMES = "a_1.png", "a_2.png", "a_10.PNG"


def write(folder, *files, names=NAMES):
    os.makedirs(folder, exist_ok=True)
    for name, data in zip(names, files):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)
    return folder


def info(path, *options):
    return subprocess.run(["isorender", path, "--info", "--json=o.json", *options], capture_output=True, text=True, timeout=20)


def values(path, *options):
    """The smallest and the largest value of each slice, and what --info says of the volume."""
    ranges = []
    for z in range(3):
        done = info(path, "--crop", "0,%d,0,%d,%d,%d" % (WIDTH - 1, HEIGHT - 1, z, z), *options)
        expect(done.returncode == 0, path, done)
        ranges.append(tuple(report("o.json")["value_range"]))
    done = info(path, *options)
    expect(done.returncode == 0, path, done)
    volume = report("o.json")["volume"]
    expect(volume["format"] == "png" and volume["dims"] == [WIDTH, HEIGHT, 3], path, volume)
    return ranges, volume


def are(path, wanted, *options, note=None, kind="uint8", spacing=(1, 1, 1)):
    ranges, volume = values(path, *options)
    expect(ranges == wanted, path, ranges, wanted)
    expect(volume["type"] == kind and volume["file_type"] == kind, path, volume)
    expect(all(abs(a - b) < 1e-6 * b for a, b in zip(volume["spacing"], spacing)), path, volume)
    expect(note is None or any(note in line for line in volume["notes"]), path, note, volume)


def refused(path, *words, status=3, options=()):
    done = subprocess.run(["isorender", path, "out.png", "--isovalue", "1", "--resolution", "16x16", *options], capture_output=True,
                          text=True, timeout=20)
    lines = done.stderr.splitlines()
    expect(done.returncode == status and len(lines) == 1 and lines[0].startswith("isorender: " + path), path, done)
    expect(all(word in lines[0] for word in words), words, lines)
    expect(not os.path.exists("out.png"), path)


def grey(low, high, depth=8, size=SIZE, **more):
    """An image whose first pixel is `low` and whose others are `high`."""
    samples = [low] + [high] * (size[0] - 1)
    rest = [high] * size[0]

    def pack(row):
        bits = "".join(format(v, "0%db" % depth) for v in row)
        bits += "0" * (-len(bits) % 8)
        return bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))

    return png_file(size, [pack(samples)] + [pack(rest)] * (size[1] - 1), depth, **more)


UNITLESS = "the distance of pixels is not stated"
are(write("in/8", *(grey(z, 200 + z) for z in range(3))), [(z, 200 + z) for z in range(3)], note=UNITLESS)
are(write("in/16", *(grey(z, 60000 + z, 16) for z in range(3))), [(z, 60000 + z) for z in range(3)], kind="uint16")
for depth in 1, 2, 4:
    top = 2 ** depth - 1
    are(write("in/%d" % depth, *(grey(0, z * top // 2, depth) for z in range(3))), [(0, z * top // 2 * 255 // top) for z in range(3)],
        note="values of %d bit" % depth)
greys = b"".join(bytes([250 - 10 * i] * 3) for i in range(16))
are(write("in/palette", *(grey(z + 4, z, 4, color=3, chunks=[(b"PLTE", greys), (b"tRNS", b"\0\1")]) for z in range(3))),
    [(210 - 10 * z, 250 - 10 * z) for z in range(3)], note=UNITLESS)
are(write("in/mixed", grey(0, 1, 1), grey(7, 9), grey(1, 0, 1, color=3, chunks=[(b"PLTE", greys)])), [(0, 255), (7, 9), (240, 250)])
# Distances: metres are pHYs's only unit.
metres, aspect = struct.pack(">IIB", 2000, 4000, 1), struct.pack(">IIB", 2, 1, 0)
are(write("in/metres", *(grey(1, 2, chunks=[(b"pHYs", metres)]) for z in range(3))), [(1, 2)] * 3, spacing=(0.5, 0.25, 0.5),
    note="the distance of slices is not stated")
are("in/metres", [(1, 2)] * 3, "--spacing", "1,2,3", spacing=(1, 2, 3))
are(write("in/aspect", *(grey(1, 2, chunks=[(b"pHYs", aspect)]) for z in range(3))), [(1, 2)] * 3, note=UNITLESS)
# Components.
for color, samples, depth in (2, 3, 8), (6, 4, 16), (4, 2, 16):
    path = write("in/color%d" % color, *(png_file(SIZE, [bytes(range(z, z + samples * depth // 8)) * WIDTH] * HEIGHT, depth, color)
                                         for z in range(3)))
    for component in range(samples):
        at = [component * depth // 8 + z for z in range(3)]
        are(path, [(v, v) if depth == 8 else (257 * v + 1,) * 2 for v in at], "--component", str(component), kind="uint%d" % depth,
            note="using %d of %d (--component)" % (component, samples))
    refused(path, "no component %d" % samples, status=2, options=["--component", str(samples)])
# The same picture of an interlaced file, in little memory, and with several threads.
SIDE = 37
balls = [lambda x, y, z=z: max(0, 255 - int(12 * ((x - 18) ** 2 + (y - 18) ** 2 + (2 * z - 18) ** 2) ** 0.5)) for z in range(19)]
names = ["slice%d.png" % z for z in range(19)]
write("in/plain", *(png_file((SIDE, SIDE), [bytes(value(x, y) for x in range(SIDE)) for y in range(SIDE)]) for value in balls), names=names)
write("in/interlaced", *(png_file((SIDE, SIDE), interlaced_rows((SIDE, SIDE), value), interlaced=True) for value in balls), names=names)
pictures = []
for path, options in ("in/plain", ["--threads", "1"]), ("in/interlaced", ["--threads", "3"]), ("in/plain", ["--chunk-size", "16"]):
    done = subprocess.run(["isorender", path, "p.png", "--isovalue", "120", "--spacing", "1,1,2", "--resolution", "48x48", "--fit", "box", *options],
                          capture_output=True, text=True)
    expect(done.returncode == 0, done)
    pictures.append(Png("p.png").rows)
expect(pictures[0] == pictures[1] == pictures[2], "pictures differ")
expect(len({pixel for row in pictures[0] for pixel in row}) > 8, "nothing is seen")

# Refused.
good = grey(1, 9)
refused(write("in/unequal", good, good, grey(1, 9, size=(10, 8))), "in/unequal/a_10.PNG: is 10 x 8 uint8", "(in/unequal/a_1.png) is 10 x 9")
refused(write("in/depths", good, grey(1, 9, 16), good), "in/depths/a_2.png: is 10 x 9 uint16")
colours = b"".join(bytes([i, 0, 9]) for i in range(16))
refused(write("in/colours", good, grey(1, 2, 4, color=3, chunks=[(b"PLTE", colours)]), good), "a_2.png: a palette of colours")
for at in sorted({*range(0, len(good) - 1, 5), len(good) - 1}):
    refused(write("in/cut", good, good[:at], good), "in/cut/a_2.png: truncated")
for at in *range(16, len(good) - 12, 7), 3:
    refused(write("in/damaged", good, good[:at] + bytes([good[at] ^ 1]) + good[at + 1:], good), "in/damaged/a_2.png: ")
rows = [b"\1" * WIDTH] * (HEIGHT - 1)
refused(write("in/short", good, png_file(SIZE, rows), good), "in/short/a_2.png: ", "damaged")
refused(write("in/strays", good, b"\xff\xd8\xff\xe0 no PNG file at all", good), "in/strays/a_2.png: damaged, or no PNG file")
write("in/fifo", good)
os.mkfifo("in/fifo/a_2.png")
refused("in/fifo", "in/fifo/a_2.png")
huge = b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", struct.pack(">IIBBBBB", 900000, 900000, 16, 6, 0, 0, 1)) + good[33:]
refused(write("in/huge", huge), "needs", "--max-memory", status=5)
refused("in/8/a_1.png", "in/8/a_1.png: is one picture", "folder")
# A hidden file is no slice, and neither is a picture beside DICOM images.
write("in/8", b"", names=["._a_1.png"])
are("in/8", [(z, 200 + z) for z in range(3)])
for z in range(3):
    slice_of("in/dicom/%d.dcm" % z, z, z + 1)
write("in/dicom", good)
done = info("in/dicom")
expect(done.returncode == 0 and report("o.json")["volume"]["format"] == "dicom", done)
P
