# Arrays of Zarr and N5 cost what is stored of them: absent chunks of one voxel, metadata that is too long, indices of shards
# that are larger than the memory, and FIFOs in place of files end at once. Transposed shards give the picture of plain chunks.
python3 - <<'P'
import json
import os
import subprocess
import time
from check import *


def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def v2(folder, shape, chunks, separator="/"):
    write(folder + "/.zarray", json.dumps({
        "zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": "|u1", "order": "C", "fill_value": 5, "filters": None,
        "compressor": None, "dimension_separator": separator}).encode())


def v3(folder, shape, shard, chunks, order=None):
    codecs = [{"name": "transpose", "configuration": {"order": order}}] if order else []
    write(folder + "/zarr.json", json.dumps({
        "zarr_format": 3, "node_type": "array", "shape": shape, "data_type": "uint8", "fill_value": 0,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": shard}},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "codecs": codecs + [{"name": "sharding_indexed", "configuration": {
            "chunk_shape": chunks, "codecs": [{"name": "bytes"}],
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}}]}).encode())


def run(*arguments, limit=60):
    """Exit status and output; a program that does not end within seconds of its own time is killed."""
    done = subprocess.run(["bash", "-c", "ulimit -t %d; exec isorender \"$@\"" % limit, "-", *arguments, "--threads", "2"],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def refused(status, what, *arguments):
    got, text = run(*arguments, "-o", "bad.png", "--quiet", limit=10)
    expect(got == status and what in text and text.count("\n") == 1, arguments, got, text)
    expect(not os.path.exists("bad.png"), "a picture")


# absent chunks: 8e9 and 1e6 of one voxel, in folders and in one folder, with names that are none of chunks
v2("in/none.zarr", [2000] * 3, [1] * 3)
status, text = run("in/none.zarr", "--info", "--max-memory", "256M", limit=20)
if status == 3 and "is not installed" in text:
    print("skipped: no module for Zarr")
    sys.exit(77)
for separator in "/.":
    folder = "in/few%s.zarr" % (separator == ".")
    v2(folder, [100] * 3, [1] * 3, separator)
    for at in ((50, 50, 50), (50, 50, 51), (51, 50, 50)):
        write(folder + "/" + separator.join(map(str, at)), b"\xc8")
    write(folder + "/" + separator.join(("050", "1", "1")), b"\xc8")
    write(folder + "/x", b"\xc8")
    for more in ([], ["--chunk-size", "32"]):
        status, text = run(folder, "-o", "few.png", "--isovalue", "100", "--resolution", "64x64", *more)
        expect(status == 0, text)
        if not more:
            expect("999997 of 1000000 tiles are not in the file: their voxels are 5" in text, text)

        # the histogram, too, of which absent chunks are a part
        status, text = run(folder, "-o", "few.png", "--resolution", "64x64", "--json=%s.json" % bool(more), *more)
        expect(status == 0, text)
    expect(report("False.json")["isovalue"] == report("True.json")["isovalue"], folder)
v2("in/none.zarr", [4000] * 3, [16] * 3)
status, text = run("in/none.zarr", "-o", "none.png", "--max-memory", "256M", limit=20)
expect(status == 6 and "every voxel is 5" in text, status, text)

# the memory suffices for all of it, of which a millionth is stored: 1 s of the processor (read whole: 10 s)
v2("in/huge.zarr", [2000] * 3, [20] * 3)
for at in range(40, 60):
    write("in/huge.zarr/%d/50/50" % at, b"\xc8" * 8000)
before = os.times()
status, text = run("in/huge.zarr", "-o", "huge.png", "--isovalue", "100", "--max-memory", "20G", "--json=huge.json",
                   "--mesh", "huge.ply", "--points", "huge-points.ply", "--quiet", limit=60)
after = os.times()
spent = after.children_user + after.children_system - before.children_user - before.children_system
expect(status == 0 and "chunks" in report("huge.json") and spent < 3, status, text, spent)

# metadata of some megabytes is not parsed
write("in/long.zarr/.zarray", b'{"zarr_format": 2, "x": [' + b"[]," * 1000000 + b"[]]}")
refused(5, "metadata of more than 1 MB", "in/long.zarr", "--max-memory", "64M")

# the index of a shard of 2^24 chunks takes 256 MB
v3("in/index.zarr", [512] * 3, [256] * 3, [1] * 3)
refused(5, "the index of its shard", "in/index.zarr", "--max-memory", "64M", "--chunk-size", "64")

# FIFOs
for name in (".zarray", "zarr.json", "attributes.json", ".zattrs"):
    os.makedirs("in/fifo%s" % name)
    os.mkfifo("in/fifo%s/%s" % (name, name))
    refused(3, "not a regular file", "in/fifo%s" % name)
v2("in/fifo_chunk.zarr", [4] * 3, [2] * 3)
os.makedirs("in/fifo_chunk.zarr/0/0")
os.mkfifo("in/fifo_chunk.zarr/0/0/0")
refused(3, "not a regular file", "in/fifo_chunk.zarr")

# shards of 4 x 8 x 6 voxels along z, y, x, stored with the axes x, z, y
value = [[[(x - 5) ** 2 + 2 * (y - 7) ** 2 + (z - 4) ** 2 for x in range(12)] for y in range(16)] for z in range(8)]
v2("in/plain.zarr", [8, 16, 12], [8, 16, 12])
write("in/plain.zarr/0/0/0", bytes(min(v, 255) for plane in value for row in plane for v in row))
order, shard, chunk = [2, 0, 1], [4, 8, 6], [3, 2, 4]  # chunks along x, z, y
v3("in/shards.zarr", [8, 16, 12], shard, chunk, order)
for sz in range(2):
    for sy in range(2):
        for sx in range(2):
            body, index = b"", b""
            for cx in range(2):
                for cz in range(2):
                    for cy in range(2):
                        part = bytes(min(value[4 * sz + 2 * cz + z][8 * sy + 4 * cy + y][6 * sx + 3 * cx + x], 255)
                                     for x in range(3) for z in range(2) for y in range(4))
                        index += struct.pack("<QQ", len(body), len(part))
                        body += part
            write("in/shards.zarr/c/%d/%d/%d" % (sz, sy, sx), body + index)
rows = {}
for name in ("plain", "shards"):
    status, text = run("in/%s.zarr" % name, "-o", name + ".png", "--isovalue", "12", "--resolution", "80x60")
    expect(status == 0, text)
    rows[name] = Png(name + ".png").rows
expect(rows["plain"] == rows["shards"], "transposed shards")
P
