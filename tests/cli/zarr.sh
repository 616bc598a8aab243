# OME-Zarr and arrays of Zarr give the picture of the .nrrd with the same voxels: both versions, compressed, in shards, with the
# axes in another order, whole and in chunks. Levels are chosen, and said; absent chunks have the fill value; damaged ones are named.
python3 - <<'P'
import json
import math
import os
import shutil
import subprocess
from check import *

DIMS = (75, 61, 53)  # x y z


def value(x, y, z):
    return int(500 + 300 * math.sin(x / 9) * math.cos(y / 7) + 150 * math.sin(z / 8 + x / 19))


def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(data)


def write_json(path, content):
    write(path, json.dumps(content).encode())


def chunk_bytes(at, sides, step, axes):
    """Voxels of the chunk whose numbers on the axes z, y, x are `at`, big-endian, the first of `axes` slowest."""
    first = [a * s for a, s in zip(at, sides)]
    data = []

    def walk(rest, place):
        if not rest:
            z, y, x = (place[axis] * step for axis in "zyx")
            data.append(value(x, y, z))
            return
        k = "zyx".index(rest[0])
        for i in range(sides[k]):
            walk(rest[1:], {**place, rest[0]: first[k] + i})

    walk(axes, {})
    return struct.pack(">%dh" % len(data), *data)


def array(folder, version, sides=(16, 24, 32), step=1, axes="zyx", coded=True, shard=None, leave_out=()):
    """An array of int16 whose axes are named in `axes`; every `step`th voxel."""
    dims = {axis: (n - 1) // step + 1 for axis, n in zip("xyz", DIMS)}
    side = dict(zip("zyx", sides))
    shape, chunks = [dims[a] for a in axes], [side[a] for a in axes]
    pack = (lambda data: zlib.compress(data, 5)) if coded else (lambda data: data)
    codecs = [{"name": "bytes", "configuration": {"endian": "big"}}]
    codecs += [{"name": "numcodecs.zlib", "configuration": {"level": 5}}] if coded else []
    outer = [c * s for c, s in zip(chunks, shard)] if shard else chunks
    if shard:
        codecs = [{"name": "sharding_indexed", "configuration": {
            "chunk_shape": chunks, "codecs": codecs,
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}]}}]
    if version == 2:
        write_json(folder + "/.zarray", {"zarr_format": 2, "shape": shape, "chunks": chunks, "dtype": ">i2", "order": "C",
                                         "fill_value": -7, "filters": None, "dimension_separator": "/",
                                         "compressor": {"id": "zlib", "level": 5} if coded else None})
        if axes != "zyx":
            write_json(folder + "/.zattrs", {"_ARRAY_DIMENSIONS": list(axes)})
    else:
        write_json(folder + "/zarr.json", {
            "zarr_format": 3, "node_type": "array", "shape": shape, "data_type": "int16", "fill_value": -7, "codecs": codecs,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": outer}},
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}}, "dimension_names": list(axes)})
    counts = [-(-n // c) for n, c in zip(shape, chunks)]
    shards = {}
    for number in range(counts[0] * counts[1] * counts[2]):
        at = (number // counts[2] // counts[1], number // counts[2] % counts[1], number % counts[2])
        if at in leave_out:
            continue
        place = dict(zip(axes, at))
        data = pack(chunk_bytes([place[a] for a in "zyx"], sides, step, axes))
        if not shard:
            write(folder + ("/c/" if version == 3 else "/") + "%d/%d/%d" % at, data)
        else:
            shards.setdefault(tuple(a // s for a, s in zip(at, shard)), {})[tuple(a % s for a, s in zip(at, shard))] = data
    for at, parts in shards.items():
        index, body = b"", b""
        for n in range(shard[0] * shard[1] * shard[2]):
            inner = (n // shard[2] // shard[1], n // shard[2] % shard[1], n % shard[2])
            part = parts.get(inner)
            index += struct.pack("<QQ", len(body), len(part)) if part is not None else b"\xff" * 16
            body += part or b""
        write(folder + "/c/%d/%d/%d" % at, body + index + struct.pack("<I", crc32c(index)))


def image(folder, version, levels, unit="micrometer"):
    """An OME-Zarr image with voxels of 2 x 2 x 3 micrometres, doubled from level to level."""
    shutil.rmtree(folder, ignore_errors=True)
    datasets = []
    for level in range(levels):
        array("%s/%d" % (folder, level), version, step=1 << level)
        scale = [3.0 * (1 << level), 2.0 * (1 << level), 2.0 * (1 << level)]
        datasets.append({"path": str(level), "coordinateTransformations": [{"type": "scale", "scale": scale}]})
    scales = [{"version": "0.4", "name": "waves", "datasets": datasets,
               "axes": [{"name": a, "type": "space", "unit": unit} for a in "zyx"]}]
    if version == 2:
        write_json(folder + "/.zgroup", {"zarr_format": 2})
        write_json(folder + "/.zattrs", {"multiscales": scales})
    else:
        write_json(folder + "/zarr.json", {"zarr_format": 3, "node_type": "group",
                                           "attributes": {"ome": {"version": "0.5", "multiscales": scales}}})


def run(name, *more):
    done = subprocess.run(["isorender", name, "--resolution", "160x120", "--camera", "iso", "--threads", "2", *more],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def nrrd(name, spacing, step=1):
    nx, ny, nz = ((n - 1) // step + 1 for n in DIMS)
    data = [value(x * step, y * step, z * step) for z in range(nz) for y in range(ny) for x in range(nx)]
    write("in/" + name, ("NRRD0004\ntype: short\ndimension: 3\nsizes: %d %d %d\nspacings: %g %g %g\nencoding: raw\n"
                         "endian: little\n\n" % (nx, ny, nz, *spacing)).encode() + struct.pack("<%dh" % len(data), *data))


def picture(name, *more):
    status, text = run(name, "-o", "out.png", "--fit", "box", *more)
    expect(status == 0, name, more, text)
    return Png("out.png").rows


nrrd("plain.nrrd", (1, 1, 1))
array("in/probe.zarr", 2)
status, text = run("in/probe.zarr", "--info")
if status == 3 and "is not installed" in text:
    print("skipped: no module for Zarr")
    sys.exit(77)
expect(status == 0 and "z 53 by 16" not in text and "axis 0 53 by 16" in text and "zlib" in text, text)
wanted = picture("in/plain.nrrd")  # with the default isovalue
for name, options in (("v2", {"version": 2}), ("v2p", {"version": 2, "coded": False}), ("v2xyz", {"version": 2, "axes": "xyz"}), ("v3", {"version": 3}),
                      ("v3xyz", {"version": 3, "axes": "xyz"}), ("v3yzx", {"version": 3, "axes": "yzx", "coded": False}),
                      ("shards", {"version": 3, "shard": (2, 2, 2)})):
    array("in/%s.zarr" % name, **options)
    for more in ([], ["--chunk-size", "32"]):
        expect(picture("in/%s.zarr" % name, *more) == wanted, name, more)

# levels: chosen by number or by the size of a pixel, and said
nrrd("fine.nrrd", (2e-3, 2e-3, 3e-3))
nrrd("coarse.nrrd", (4e-3, 4e-3, 6e-3), 2)
fine, coarse = picture("in/fine.nrrd", "--isovalue", "520.5"), picture("in/coarse.nrrd", "--isovalue", "520.5")
for version in (2, 3):
    image("in/image.zarr", version, 3)
    expect(picture("in/image.zarr", "--isovalue", "520.5") == fine, version)
    expect(picture("in/image.zarr", "--isovalue", "520.5", "--level", "1") == coarse, version)
    for size, level in (("1000x800", 0), ("60x48", 1), ("24x20", 2), ("2x2", 2)):
        status, text = run("in/image.zarr", "--resolution", size, "-o", "out.png", "--level", "auto", "--json=r.json",
                           "--isovalue", "520.5")
        expect(status == 0 and "level %d" % level in text, size, text)
        notes = " ".join(report("r.json")["volume"]["notes"])
        expect(("level %d of 3" % level in notes) == (level > 0), size, notes)
    status, text = run("in/image.zarr", "-o", "out.png", "--level", "3")
    expect(status == 2 and "no level 3, there are 3" in text, text)
status, text = run("in/image.zarr", "--info")
for part in ("OME-Zarr 0.5", "Zarr v3", "waves", "level 2: 2, voxels of 0.008 x 0.008 x 0.012 mm", "z 53 by 16"):
    expect(part in text, part, text)
status, text = run("in/plain.nrrd", "-o", "out.png", "--level", "1")
expect(status == 0 and "has one level" in text, text)
status, text = run("in/plain.nrrd", "-o", "out.png", "--level", "x")
expect(status == 2, text)

# absent and damaged chunks
array("in/holes.zarr", 2, leave_out=((0, 0, 0), (3, 2, 2)))
status, text = run("in/holes.zarr", "--info")
expect(status == 0 and "2 of 36 tiles are not in the file: their voxels are -7" in text, text)
expect(picture("in/holes.zarr", "--isovalue", "520.5") == picture("in/holes.zarr", "--isovalue", "520.5", "--chunk-size", "16"))
with open("in/holes.zarr/1/1/1", "r+b") as file:
    file.truncate(100)
for more in ([], ["--chunk-size", "32"]):
    status, text = run("in/holes.zarr", "-o", "bad.png", "--isovalue", "520.5", *more)
    expect(status == 3 and "holes.zarr/1/1/1: damaged (zlib)" in text and not os.path.exists("bad.png"), status, text)
P
