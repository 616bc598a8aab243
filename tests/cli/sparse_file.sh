# A raw file of 64 GiB that is all but empty is drawn with 512 MiB of memory, and its holes are not read.
python3 - <<'P'
import math

side, low, size = 4096, 1800, 96
with open("in/a.raw", "wb") as file:
    for z in range(size):
        for y in range(size):
            file.seek(((low + z) * side + low + y) * side + low)
            file.write(bytes(max(0, 255 - 5 * int(math.sqrt((x - 48) ** 2 + (y - 48) ** 2 + (z - 48) ** 2))) for x in range(size)))
    file.truncate(side ** 3)
P
ulimit -d 524288
isorender in/a.raw --raw 4096x4096x4096:uint8 --isovalue 100 -o a.png --resolution 200x200 --max-memory 400M --json=a.json --quiet --threads 2
python3 - <<'P'
from check import *
said = report("a.json")
expect(said["chunks"]["bytes_read"] < 1 << 30, said["chunks"])
bounds = said["bounds_local"]
expect(all(abs((bounds[2 * a] + bounds[2 * a + 1]) / 2 - 1848) < 0.6 for a in range(3)), bounds)
expect(all(abs((bounds[2 * a + 1] - bounds[2 * a]) / 2 - 31) < 1 for a in range(3)), bounds)
expect(said["peak_bytes"] < 700 << 20, said["peak_bytes"])
P
