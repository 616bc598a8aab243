# A volume drawn in chunks gives the bytes of the whole: for every size of chunk, and when it does not fit into --max-memory,
# whether its voxels lie in the file as they are needed or must be unpacked or converted, or in tiles.
python3 - <<'P'
import gzip
import math
import os
import subprocess
from check import *

dims = (150, 131, 141)
value = lambda x, y, z: int(500 + 300 * math.sin(x / 9) * math.cos(y / 7) + 150 * math.sin(z / 8 + x / 19))
row = [value(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]
count = len(row)
little, big = struct.pack("<%dh" % count, *row), struct.pack(">%dh" % count, *row)
doubles = struct.pack("<%dd" % count, *row)
header = "NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nencoding: %s\nendian: %s\n"


def write(name, text, data):
    with open("in/" + name, "wb") as file:
        file.write(text.encode() + data)


for pad in range(2):  # voxels at an odd place in the file cannot be used where they are
    write("plain%d.nrrd" % pad, header % ("short", *dims, "raw", "little") + "#" + "-" * (pad + 1) + "\n\n", little)
write("big.nrrd", header % ("short", *dims, "raw", "big") + "\n", big)
write("double.nrrd", header % ("double", *dims, "raw", "little") + "\n", doubles)
write("packed.nrrd", header % ("short", *dims, "gzip", "little") + "\n", gzip.compress(little, 1))
write("plain.mha", "ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\nElementType = MET_SHORT\nElementByteOrderMSB = False\n"
      "ElementDataFile = LOCAL\n" % dims, little)
write("v_%dx%dx%d_int16.raw" % dims, "", little)
write("plain.vtk", "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS %d %d %d\nORIGIN 0 0 0\n"
      "SPACING 1 1 1\nPOINT_DATA %d\nSCALARS s short 1\nLOOKUP_TABLE default\n" % (*dims, count), big)
write("plain.hdr", "", nifti_header(dims, 4, 16))
write("plain.img", "", little)


def tiff(name, tile):
    """A page for each slice, of square tiles, or of strips of `tile` rows if that is odd."""
    width, height = (dims[0], tile) if tile % 2 else (tile, tile)
    out = bytearray(b"II*\0\0\0\0\0")
    link = 4
    for z in range(dims[2]):
        places = []
        for y in range(0, dims[1], height):
            for x in range(0, dims[0], width):
                places.append(len(out))
                for line in range(y, y + height if tile % 2 == 0 else min(y + height, dims[1])):
                    first = 2 * ((z * dims[1] + min(line, dims[1] - 1)) * dims[0] + x)
                    out += little[first:first + 2 * width].ljust(2 * width, b"\0")
        sizes = [b - a for a, b in zip(places, places[1:] + [len(out)])]
        tables = [len(out), len(out) + 4 * len(places)]
        out += struct.pack("<%dI" % (2 * len(places)), *places, *sizes)
        kind = (278, 273, 279) if tile % 2 else (323, 324, 325)
        tags = [(256, dims[0]), (257, dims[1]), (258, 16), (259, 1), (262, 1), (277, 1), (339, 2), (kind[0], tile)]
        tags += [] if tile % 2 else [(322, tile)]
        entries = sorted([(tag, 3, 1, value) for tag, value in tags] +
                         [(kind[1], 4, len(places), tables[0]), (kind[2], 4, len(places), tables[1])])
        struct.pack_into("<I", out, link, len(out))
        out += struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries)
        link = len(out)
        out += bytes(4)
    write(name, "", out)


tiff("tiles.tif", 64)
tiff("strips.tif", 9)


def run(*arguments):
    done = subprocess.run(["isorender", *arguments, "--resolution", "160x120", "--isovalue", "520.5", "--quiet", "--camera", "iso", "--fit", "box",
                           "--threads", "2"],
                          capture_output=True, text=True)
    return done.returncode, done.stderr


def picture(name):
    return Png(name).rows


expect(run("in/plain0.nrrd", "whole.png")[0] == 0)
whole = open("whole.png", "rb").read()
for side in (16, 32, 64, 128, 200, 1000):
    expect(run("in/plain0.nrrd", "chunks.png", "--chunk-size", str(side), "-o", "plain0.png")[0] == 2)  # two names
    expect(run("in/plain0.nrrd", "-o", "chunks.png", "--chunk-size", str(side))[0] == 0)
    expect(open("chunks.png", "rb").read() == whole, side)
for name in ("plain0.nrrd", "plain1.nrrd", "big.nrrd", "double.nrrd", "packed.nrrd", "plain.mha", "v_%dx%dx%d_int16.raw" % dims,
             "plain.vtk", "plain.hdr", "tiles.tif", "strips.tif"):
    status, text = run("in/" + name, "all.png")
    if status == 3 and ("built without" in text or "is not installed" in text):
        continue
    expect(status == 0, name, text)
    expect(not name.endswith(".tif") or picture("all.png") == picture("whole.png"), name)
    status, text = run("in/" + name, "streamed.png", "--max-memory", "5M")
    expect(status == 0, name, text)
    expect(open("all.png", "rb").read() == open("streamed.png", "rb").read(), name)
    # what cannot be made in chunks is still refused from the header
    status, text = run("in/" + name, "--no-image", "--mesh", "m.stl", "--max-memory", "5M")
    expect(status == 5 and "--max-memory" in text, name, status, text)

# points and meshes are those of the whole, byte for byte, with and without a picture
expect(run("in/plain0.nrrd", "--no-image", "--points", "whole_p.ply", "--mesh", "whole_m.ply")[0] == 0)
for more in (["-o", "with.png", "--max-memory", "5M"], ["--no-image", "--max-memory", "5M"], ["--no-image", "--chunk-size", "48"]):
    status, text = run("in/plain0.nrrd", "--points", "p.ply", "--mesh", "m.ply", *more)
    expect(status == 0, more, text)
    for name in ("p.ply", "m.ply"):
        expect(open(name, "rb").read() == open("whole_" + name, "rb").read(), name, more)
expect(open("with.png", "rb").read() == whole)
for more, reason in ((["--mesh", "m.stl"], "written as .ply"), (["--mesh", "m.ply", "--part", "1/2", "-o", "a.isokeys"], "one process")):
    status, text = run("in/plain0.nrrd", "--chunk-size", "48", *more)
    expect(status == 2 and reason in text, more, status, text)
os.mkfifo("pipe.ply")
reader = subprocess.Popen(["cat", "pipe.ply"], stdout=subprocess.DEVNULL)
status, text = run("in/plain0.nrrd", "--no-image", "--chunk-size", "48", "--points", "pipe.ply")
reader.wait()
expect(status == 7 and "regular file" in text, status, text)

# cropped
for name, side in (("tiles.tif", 32), ("strips.tif", 48)):
    if run("in/" + name, "all.png", "--crop", "3,140,7,120,18,131")[0] == 0:
        status, text = run("in/" + name, "-o", "streamed.png", "--crop", "3,140,7,120,18,131", "--chunk-size", str(side))
        expect(status == 0 and picture("all.png") == picture("streamed.png"), name, text)

with open("in/short.nrrd", "wb") as file:
    file.write((header % ("short", *dims, "raw", "little") + "\n").encode() + little[:-2])
status, text = run("in/short.nrrd", "short.png", "--max-memory", "5M")
expect(status == 3 and "truncated" in text, status, text)
P
