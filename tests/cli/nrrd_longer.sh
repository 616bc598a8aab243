# Data in a file of their own that go on behind the array are noted, because the array may begin elsewhere; those behind an
# attached array, and what a byte skip leaves at the end, are not.
python3 - <<'P'
import bz2, gzip, subprocess
from check import *

values = [((x - 5) ** 2 + (y - 5) ** 2 + (z - 5) ** 2) for z in range(11) for y in range(11) for x in range(11)]
data = struct.pack("<1331h", *values)
header = "NRRD0004\ntype: short\ndimension: 3\nsizes: 11 11 11\nendian: little\nencoding: %s\n"
text = lambda v: " ".join(map(str, v)).encode() + b"\n"
pack = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress, "hex": lambda d: d.hex().encode() + b"\n"}


def notes(encoding, body, fields="data file: d.bin\n", attached=b""):
    open("in/a.nhdr", "wb").write((header % encoding + fields + "\n").encode() + attached)
    open("in/d.bin", "wb").write(body)
    done = subprocess.run(["isorender", "in/a.nhdr", "a.png", "--isovalue", "9", "--resolution", "24x24"], capture_output=True, text=True)
    expect(done.returncode == 0, encoding, done)
    return sum("d.bin goes on behind the array" in line for line in done.stderr.splitlines())


for encoding in pack:
    expect(notes(encoding, pack[encoding](data)) == 0, encoding)
    expect(notes(encoding, pack[encoding](data + bytes(352))) == 1, encoding, "longer")
    if encoding != "hex":
        expect(notes(encoding, pack[encoding](bytes(352) + data), "byte skip: -1\ndata file: d.bin\n") == 0, encoding, "skip -1")
    expect(notes(encoding, b"", "", pack[encoding](data + bytes(352))) == 0, encoding, "attached")
expect(notes("text", text(values)) == 0, "text")
expect(notes("text", text(values + [1, 2])) == 1, "longer text")
P
