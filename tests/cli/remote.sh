# Zarr and OME-Zarr on a web server give the picture of the same folder, also where the server is slow or busy or breaks off; what
# was read is kept, and read again only if it has changed; of an image of 1.1 TB little is asked, and nothing beside it. Single files of
# every kind are copied to the same cache, and give the picture of the file.
isorender http://127.0.0.1:9/x.zarr --info 2>&1 | grep -q 'not installed' && { echo "built without libcurl"; exit 77; }
cat >in/make.py <<'P'
import json, math, os
from check import *

SIDE, CHUNK = 40, 16
value = lambda x, y, z, step: max(0, min(255, int(128 + 60 * math.sin(x * step / 6) + 40 * math.cos(y * step / 5) - 2 * abs(z * step - 20))))

def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    open(path, "wb").write(data if isinstance(data, bytes) else json.dumps(data).encode())

def chunk(at, step, shift):
    z, y, x = (CHUNK * a for a in at)
    return zlib.compress(bytes((value(x + i, y + j, z + k, step) + shift) % 256 for k in range(CHUNK) for j in range(CHUNK) for i in range(CHUNK)))

def level(folder, step, shift=0):
    side = SIDE // step
    write(folder + "/.zarray", {"zarr_format": 2, "shape": [side] * 3, "chunks": [CHUNK] * 3, "dtype": "|u1", "compressor": {"id": "zlib", "level": 1},
                                "fill_value": 7, "order": "C", "filters": None})
    count = (side - 1) // CHUNK + 1
    for at in [(z, y, x) for z in range(count) for y in range(count) for x in range(count)]:
        if at != (0, 1, 1): # is absent
            write("%s/%d.%d.%d" % (folder, *at), chunk(at, step, shift))

def image(folder, shift=0):
    write(folder + "/.zattrs", {"multiscales": [{"version": "0.4", "axes": [{"name": a, "type": "space", "unit": "millimeter"} for a in "zyx"], "datasets":
        [{"path": str(i), "coordinateTransformations": [{"type": "scale", "scale": [2 ** i] * 3}]} for i in range(2)]}]})
    level(folder + "/0", 1, shift)
    level(folder + "/1", 2, shift)

def shards(folder, index_at_start):
    """An array of Zarr 3 of 48 voxels in shards of 32 with chunks of 16; one shard and some chunks are absent."""
    codecs = [{"name": "bytes"}, {"name": "gzip", "configuration": {"level": 1}}]
    write(folder + "/zarr.json", {"zarr_format": 3, "node_type": "array", "shape": [48] * 3, "data_type": "uint8", "fill_value": 9,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [32] * 3}}, "chunk_key_encoding": {"name": "default"},
        "codecs": [{"name": "sharding_indexed", "configuration": {"chunk_shape": [CHUNK] * 3, "codecs": codecs, "index_location": "start" if index_at_start else "end",
                    "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}, {"name": "crc32c"}]}}]})
    for at in [(z, y, x) for z in range(2) for y in range(2) for x in range(2)]:
        if at == (1, 0, 1):
            continue
        index, body, start = b"", b"", 8 * 16 + 4 if index_at_start else 0
        for inner in [(z, y, x) for z in range(2) for y in range(2) for x in range(2)]:
            place = tuple(2 * a + i for a, i in zip(at, inner))
            if max(place) > 2 or place == (1, 1, 1):
                index += b"\xff" * 16
                continue
            packer = zlib.compressobj(1, zlib.DEFLATED, 31)
            data = packer.compress(zlib.decompress(chunk(place, 1, 0))) + packer.flush()
            index += struct.pack("<QQ", start + len(body), len(data))
            body += data
        index += struct.pack("<I", crc32c(index))
        write("%s/c/%d/%d/%d" % (folder, *at), index + body if index_at_start else body + index)

image("in/image.zarr", int(sys.argv[1]) if len(sys.argv) > 1 else 0)
if len(sys.argv) == 1:
    shards("in/end.zarr", False)
    shards("in/start.zarr", True)
    side = 110 # more than a block of the copy
    voxels = b"".join(bytes(value(x, y, z, .4) for x in range(side)) for z in range(side) for y in range(side))
    write("in/v.nrrd", b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n" % (side, side, side) + voxels)
    write("in/v.raw", voxels)
    write("in/page.nrrd", b"<html>" + b" " * 5000)
P
isorender scene:torus:24 --no-image --points in/cloud.ply --quiet
python3 in/make.py
echo >in/.behaviour
web=$(dirname "$(python3 -c 'import check; print(check.__file__)')")/web_server.py
python3 "$web" in web.log web.port & server=$!
trap 'kill $server' EXIT
for _ in $(seq 200); do [ -e web.port ] && break; sleep .05; done
url=http://127.0.0.1:$(cat web.port)
export XDG_CACHE_HOME=$PWD/kept

asked() { grep -v json web.log | grep -v '/\.z' | grep -c " $1 " || true; } # STATUS: of chunks and shards
# same FILE [OPTION..]: the server's is drawn as the folder's. The log then has what this picture has asked.
same() {
    isorender "in/$1" a.png --isovalue 120 --resolution 80x80 --quiet --json=a.json "${@:2}"
    rm -f web.log
    isorender "$url/$1" b.png --isovalue 120 --resolution 80x80 --quiet --json=b.json "${@:2}"
    python3 -c 'from check import *
a, b = report("a.json"), report("b.json")
expect(a["image"]["hash"] == b["image"]["hash"], sys.argv)' "$@"
}
same image.zarr
[ "$(asked 200)" -eq 26 ]
! grep -v '^/image.zarr/' web.log
[ -z "$(cut -d' ' -f1 web.log | sort | uniq -d)" ] # nothing is asked twice
same image.zarr # again: nothing has changed
[ "$(asked 304)" -eq 26 ] && [ "$(asked 200)" -eq 0 ]
same image.zarr --level 1
python3 in/make.py 11 # other voxels
same image.zarr
[ "$(asked 304)" -eq 0 ]
same image.zarr --chunk-size 20
same end.zarr
same start.zarr
same end.zarr
[ "$(asked 206)" -eq 0 ]
for behaviour in busy short wait=.05; do
    rm -rf kept
    kill $server
    echo $behaviour >in/.behaviour
    rm web.port
    python3 "$web" in web.log web.port & server=$!
    for _ in $(seq 200); do [ -e web.port ] && break; sleep .05; done
    url=http://127.0.0.1:$(cat web.port)
    same image.zarr
    same start.zarr
    same v.nrrd
done

# an image of 1.1 TB: the level that fits, and no more
echo >in/.behaviour
rm -f web.log
isorender "$url/huge" huge.png --isovalue 128 --resolution 128x128 --level auto --quiet --json=huge.json
python3 -c 'from check import *
rows = [line.split() for line in open("web.log")]
total = sum(int(r[2]) for r in rows)
expect(all(r[0].startswith("/huge/") for r in rows), "asked beside it")
expect(total < 64 << 20, total, "bytes")
expect(report("huge.json")["image"]["covered"] > 4 * 3000, "the ball is not there")'

# the cache keeps to its size, and need not be
rm -rf kept
ISO_REMOTE_CACHE=0 isorender "$url/image.zarr" c.png --isovalue 120 --resolution 80x80 --quiet
[ ! -e kept ]
ISO_REMOTE_CACHE=1 isorender "$url/huge" c.png --isovalue 128 --level 6 --resolution 80x80 --quiet
[ "$(du -sk kept | cut -f1)" -le 1100 ]

# single files: asked for once, and again only whether they have changed
same v.nrrd
[ "$(cat web.log)" = "/v.nrrd 200 $(stat -c %s in/v.nrrd)" ]
same v.nrrd
[ "$(cat web.log)" = "/v.nrrd 304 0" ]
printf '\377' | dd of=in/v.nrrd bs=1 seek=200000 conv=notrunc status=none
same v.nrrd
[ "$(cat web.log)" = "/v.nrrd 200 $(stat -c %s in/v.nrrd)" ]
truncate -s -5 kept/isopoint/remote/*-v.nrrd # a copy that is not whole
same v.nrrd
[ "$(cat web.log)" = "/v.nrrd 200 $(stat -c %s in/v.nrrd)" ]
same v.raw --raw 110x110x110:uint8
same v.nrrd --chunk-size 20
isorender "$url/v.nrrd" --info | grep -q "voxels      110 x 110 x 110, uint8"
# same_picture NAME [ARGUMENT..]: @ stands for the folder, and for the server
same_picture() {
    isorender "${@//@/in}" a.png --resolution 80x80 --quiet --json=a.json
    isorender "${@//@/$url}" b.png --resolution 80x80 --quiet --json=b.json
    python3 -c 'from check import *
expect(report("a.json")["image"]["hash"] == report("b.json")["image"]["hash"], sys.argv)' "$@"
}
isorender scene:torus:24 --no-image --mesh in/torus.glb --quiet
isorender scene:torus:24 --no-image --mesh in/torus.stl --quiet
gzip -k in/v.nrrd
printf 'x,y,z,r\n0,0,0,1\n3,1,0,2\n' >in/balls.csv
same_picture @/cloud.ply
same_picture @/v.nrrd --isovalue 120 --volume @/v.nrrd
same_picture @/v.nrrd --isovalue 120 --surface-color-by @/v.nrrd
same_picture --surface @/torus.glb
same_picture --surface @/torus.stl
same_picture --glyphs @/balls.csv
same_picture @/v.nrrd --isovalue 120 --clip x --cap slice
isocompare surfaces "$url/torus.stl" in/torus.glb --quiet --json=c.json
for place in in "$url"; do
    isosculpt --headless --open "$place/v.nrrd" --isovalue 120 --mesh "$(basename "$place").ply" --quiet
done
cmp in.ply "$(basename "$url").ply"
isorender "$url/v.nrrd?token=1" q.png --isovalue 120 --resolution 80x80 --quiet

isorender_refuses 3 "$url/w.nrrd?token=1: cannot be read: the server answers 404" "$url/w.nrrd?token=1"
isorender_refuses 3 "$url/w.stl: cannot be read: the server answers 404" --surface "$url/w.stl"
isorender_refuses 3 "$url/page.nrrd: not an NRRD file" "$url/page.nrrd"
ISO_REMOTE_CACHE=0 isorender_refuses 3 "files of servers are copied to a cache, which there is none of" "$url/v.nrrd" --isovalue 120

isorender_refuses 3 "$url/none: holds no" "$url/none"
echo broken >in/.behaviour
rm -rf kept
isorender_refuses 3 "$url/image.zarr/.zattrs: cannot be read: " "$url/image.zarr"
isorender_refuses 3 "$url/v.nrrd: cannot be read: " "$url/v.nrrd" --isovalue 120
echo parts=no >in/.behaviour
rm -rf kept
isorender_refuses 3 "its server does not send parts of files: copy it here" "$url/end.zarr" --isovalue 120
kill $server
isorender_refuses 3 "cannot be read: Couldn't connect to server" "$url/image.zarr"
trap - EXIT
