# The index beside a volume is written without being asked for: never through a link, and over nothing but an index.
python3 - <<'P'
import os
import subprocess
from check import *

n = 96
voxels = bytes(max(0, 200 - 6 * int(((x - 48) ** 2 + (y - 48) ** 2 + (z - 48) ** 2) ** .5)) for z in range(n) for y in range(n) for x in range(n))
with open("in/v.raw", "wb") as file:
    file.write(voxels)


def draw(name):
    done = subprocess.run(["isorender", "in/v.raw", "--raw", "96x96x96:uint8", "--isovalue", "90", "--max-memory", "800k", "--chunk-size", "32",
                           "--threads", "1", "--resolution", "48x48", "--quiet", "-o", name], capture_output=True, text=True, timeout=60)
    expect(done.returncode == 0 and not done.stderr, done.stderr)
    return open(name, "rb").read()


index = "in/v.raw.isoindex"
first = draw("a.png")
expect(os.path.exists(index), "no index")
for kind in ("the volume", "a file", "nothing", "a hard link", "text", "a fifo", "a folder"):
    os.remove(index)
    with open("in/precious", "w") as file:
        file.write("precious")
    if kind in ("the volume", "a file", "nothing"):
        os.symlink({"the volume": "v.raw", "a file": "precious", "nothing": "missing"}[kind], index)
    elif kind == "a hard link":
        os.link("in/v.raw", index)
    elif kind == "text":
        os.rename("in/precious", index)
    elif kind == "a fifo":
        os.mkfifo(index)
    else:
        os.mkdir(index)
    expect(draw("b.png") == first, kind)
    expect(open("in/v.raw", "rb").read() == voxels, kind)
    expect(open(index if kind == "text" else "in/precious").read() == "precious", kind)
    expect(not os.path.exists("in/missing"), kind)
    expect(len(os.listdir("in")) == (2 if kind == "text" else 3), os.listdir("in"))
    if kind == "a folder":
        os.rmdir(index)
P
