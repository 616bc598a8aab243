# An index beside a volume that does not fit into memory: later pictures have the same bytes, and read only the chunks that
# they show; an index of another file, or a damaged one, is not used.
python3 - <<'P'
import os
import subprocess
from check import *
import math

dims = (200, 190, 180)


def write(shift):
    def value(x, y, z):
        return 200 - 10 * min(20, int(math.sqrt((x - 30 - shift) ** 2 + (y - 40) ** 2 + (z - 35) ** 2)))
    row = [value(x, y, z) for z in range(70) for y in range(dims[1]) for x in range(dims[0])]
    with open("in/a.nrrd", "wb") as file:
        file.write(("NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n" % dims).encode())
        file.write(bytes(row))
        file.write(bytes(dims[0] * dims[1] * (dims[2] - 70)))


def run(name, *arguments):
    done = subprocess.run(["isorender", "in/a.nrrd", "-o", name, "--isovalue", "100", "--resolution", "120x90", "--fit", "box", "--threads", "2",
                           "--json=%s.json" % name, *arguments], capture_output=True, text=True)
    expect(done.returncode == 0, done.stderr)
    return open(name, "rb").read(), report(name + ".json"), done.stderr


write(0)
whole = run("whole.png", "--quiet")[0]
expect(not os.path.exists("in/a.nrrd.isoindex"))
for number in range(3):
    picture, said, _ = run("a.png", "--max-memory", "5M", "--quiet")
    chunks = said["chunks"]
    expect(picture == whole, number)
    expect(os.path.exists("in/a.nrrd.isoindex"))
    size = dims[0] * dims[1] * dims[2]
    if number == 0:
        expect(chunks["bytes_read"] >= size, chunks)
    else:
        expect(chunks["bytes_read"] <= 1.2 * chunks["bytes_crossed"] and chunks["bytes_read"] < size / 2, chunks)
    first = said if number == 0 else first
    expect(said["bounds_world"] == first["bounds_world"] and said["primitives"] == first["primitives"] and said["primitives"]["cells"] > 100)
with open("in/a.nrrd.isoindex", "r+b") as file:  # damaged
    middle = os.path.getsize("in/a.nrrd.isoindex") // 2
    file.seek(middle)
    byte = file.read(1)
    file.seek(middle)
    file.write(bytes([byte[0] ^ 1]))
picture, said, _ = run("a.png", "--max-memory", "5M", "--quiet")
expect(picture == whole and said["chunks"]["bytes_read"] >= size, said["chunks"])
index = open("in/a.nrrd.isoindex", "rb").read()
picture, said, _ = run("a.png", "--max-memory", "5M", "--quiet", "--no-index")
expect(picture == whole and said["chunks"]["bytes_read"] >= size)
write(40)  # another file of the same name and size
whole = run("whole.png", "--quiet")[0]
picture, said, _ = run("a.png", "--max-memory", "5M", "--quiet")
expect(picture == whole and said["chunks"]["bytes_read"] >= size, said["chunks"])
expect(open("in/a.nrrd.isoindex", "rb").read() != index)
# parts use it too, and a part of the file is another volume
for k in (1, 2):
    subprocess.run(["isorender", "in/a.nrrd", "--isovalue", "100", "--resolution", "120x90", "--fit", "box", "--part", "%d/2" % k, "-o",
                    "%d.isokeys" % k, "--quiet"], check=True)
subprocess.run(["isorender", "merge", "1.isokeys", "2.isokeys", "-o", "merged.png", "--quiet"], check=True)
expect(open("merged.png", "rb").read() == whole)
crop = ["--crop", "20,150,10,180,5,170"]
expect(run("whole.png", "--quiet", *crop)[0] == run("a.png", "--max-memory", "4M", "--quiet", *crop)[0])
P
