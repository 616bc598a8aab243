# An index of another file is not used, whatever its size and times have been set to; neither is one that contradicts itself.
python3 - <<'P'
import os
import shutil
import struct
import subprocess
from check import *

n = 96
for name, c in (("a", (48, 48, 48)), ("b", (30, 66, 48))):
    with open("in/%s.raw" % name, "wb") as file:
        file.write(bytes(max(0, 200 - 6 * int(((x - c[0]) ** 2 + (y - c[1]) ** 2 + (z - c[2]) ** 2) ** .5)) for z in range(n) for y in range(n) for x in range(n)))
    os.utime("in/%s.raw" % name, (1700000000, 1700000000))


def draw(name, *arguments):
    done = subprocess.run(["isorender", "in/v.raw", "--raw", "96x96x96:uint8", "--isovalue", "90", "--max-memory", "800k", "--chunk-size", "32",
                           "--threads", "1", "--resolution", "48x48", "--quiet", "-o", name, *arguments], capture_output=True, text=True)
    expect(done.returncode == 0 and not done.stderr, done.stderr)
    return open(name, "rb").read()


index = "in/v.raw.isoindex"
shutil.copy2("in/a.raw", "in/v.raw")  # as cp -p
draw("a.png")
before = os.stat("in/v.raw")
shutil.copy2("in/b.raw", "in/v.raw")
after = os.stat("in/v.raw")
expect((before.st_size, before.st_mtime_ns, before.st_ino) == (after.st_size, after.st_mtime_ns, after.st_ino), "the times differ")
right = draw("b.png", "--no-index")
expect(draw("c.png") == right, "the index of another file was used")

# ---- bounds that are not numbers, in an index whose checksum is right
data = open(index, "rb").read()
expect(struct.unpack("<I", data[-4:])[0] == crc32c(data[:-4]), "this test computes another checksum")
head = data.index(struct.pack("<d", 90.0))  # the isovalue of the surface
for i in range(12):
    at = head + 24 + 8 * i
    lie = data[:at] + struct.pack("<d", (float("nan"), float("inf"), 1e6)[i % 3]) + data[at + 8:-4]
    with open(index, "wb") as file:
        file.write(lie + struct.pack("<I", crc32c(lie)))
    expect(draw("d.png") == right, i)
    expect(open(index, "rb").read() == data, "the index was not made again")
P
