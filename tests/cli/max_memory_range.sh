# Around the size of the voxels, every --max-memory gives the picture that there is without a limit, or says that it is too
# small; and once it is enough, more is.
python3 - <<'P'
import math
import os
import subprocess
from check import *

dims = (170, 150, 140)
slice = [int(500 + 300 * math.sin(x / 9) * math.cos(y / 7)) for y in range(dims[1]) for x in range(dims[0])]
row = [value + shift for shift in (int(150 * math.sin(z / 8)) for z in range(dims[2])) for value in slice]
voxels = 2 * len(row)
with open("in/a.nrrd", "wb") as file:
    file.write(("NRRD0004\ntype: short\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n\n" % dims).encode())
    file.write(struct.pack("<%dh" % len(row), *row))


def run(limit, *more, stdin=None):
    for name in ("a.png", "p.ply", "in/a.nrrd.isoindex"):
        if os.path.exists(name):
            os.remove(name)
    done = subprocess.run(["isorender", "-" if stdin else "in/a.nrrd", "-o", "a.png", "--resolution", "120x90", "--fit", "box", "--threads", "2",
                           *(["--max-memory", "%dB" % limit] if limit else []), *more], stdin=stdin, capture_output=True, text=True)
    return done.returncode, done.stderr


def lines(text):
    return sorted(line for line in text.splitlines() if "wrote" not in line)


def sweep(*more):
    status, text = run(0, *more)
    expect(status == 0, more, text)
    written = [name for name in ("a.png", "p.ply") if os.path.exists(name)]
    whole, said = [open(name, "rb").read() for name in written], lines(text)
    drawn, refused, chunks = 0, 0, 0
    for percent in (5, 20, 40, 60, 80, 90, 95, 99, 100, 101, 102, 104, 107, 110, 115, 120, 130, 140, 160, 180, 200, 250, 300, 400,
                    600, 1000):
        status, text = run(voxels * percent // 100, *more, "--json=a.json")
        if status == 0:
            drawn += 1
            chunks += "chunks" in report("a.json")
            expect([open(name, "rb").read() for name in written] == whole, more, percent)
            expect(lines(text) == said, more, percent, text, said)
        else:
            refused += 1
            expect(status == 5 and "--max-memory" in text and not drawn, more, percent, status, text, drawn)
            expect(not os.path.exists("a.png") and not os.path.exists("p.ply"), more, percent)
    expect(drawn >= 20 and refused >= 1 and 0 < chunks < drawn, more, drawn, refused, chunks)


sweep("--isovalue", "520.5")
sweep()  # the isovalue is logged once
sweep("--isovalue", "520.5", "--method", "pullpush", "--reconstruction", "box", "--primitive", "edge")
sweep("--isovalue", "520.5", "--points", "p.ply")

# what is read from a pipe is there for the second attempt
status, text = run(0, "--isovalue", "520.5")
whole = Png("a.png").rows
with open("in/a.nrrd", "rb") as file:
    status, text = run(voxels * 110 // 100, "--isovalue", "520.5", "--verbose", stdin=file)
expect(status == 0 and "in chunks" in text and Png("a.png").rows == whole, status, text)
P
