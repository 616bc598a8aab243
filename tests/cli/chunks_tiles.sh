# Compressed tiles in a small memory are decoded once when the volume is passed through, and those of crossed bricks again when
# they are drawn, where the memory is very small some of them twice: the picture is that of the whole.
python3 - <<'P'
import json
import math
import os
import subprocess
import zlib
from check import *

side, tile = 256, 64
os.mkdir("in/a.zarr")
with open("in/a.zarr/.zarray", "w") as file:
    json.dump({"zarr_format": 2, "shape": [side] * 3, "chunks": [tile] * 3, "dtype": "|u1", "compressor": {"id": "zlib", "level": 1},
               "fill_value": 0, "order": "C", "filters": None}, file)
wave = [[int(60 + 50 * math.sin(x / 9) * math.cos(y / 11)) for x in range(side)] for y in range(side)]
fade = [0 if z < 90 else min(100, 2 * (z - 90)) for z in range(side)]
for z in range(0, side, tile):
    for y in range(0, side, tile):
        for x in range(0, side, tile):
            data = b"".join(bytes(value * fade[k] // 100 for value in wave[j][x:x + tile])
                            for k in range(z, z + tile) for j in range(y, y + tile))
            with open("in/a.zarr/%d.%d.%d" % (z // tile, y // tile, x // tile), "wb") as file:
                file.write(zlib.compress(data, 1))


def run(*arguments):
    done = subprocess.run(["isorender", "in/a.zarr", "-o", "a.png", "--isovalue", "75", "--resolution", "120x90", "--fit", "box", "--samples", "1", "--threads", "2",
                           "--quiet", "--json=a.json", *arguments], capture_output=True, text=True)
    if done.returncode == 3 and "not installed" in done.stderr:
        print("SKIP: built without Zarr")
        raise SystemExit(0)
    expect(done.returncode == 0, done.stderr)
    return Png("a.png").rows, report("a.json").get("chunks")


whole, chunks = run()
expect(chunks is None)
voxels = side ** 3
crossed = voxels - tile * side ** 2  # all tiles but the lowest layer
for limit, times in ("10M", 1.8), ("22M", 1.02):
    if os.path.exists("in/a.zarr.isoindex"):
        os.remove("in/a.zarr.isoindex")
    for frame in range(2):
        picture, chunks = run("--max-memory", limit)
        expect(picture == whole, limit, frame)
        expect(crossed <= chunks["bytes_decoded"] <= (voxels if frame == 0 else 0) + times * crossed, limit,
               frame, chunks)
P
