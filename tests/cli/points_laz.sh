# Compressed scans (LAZ, COPC): every point format that is read, pointwise and in layers, in chunks of any length, with extra bytes,
# scanner's channels, times in several sequences and wild numbers, against the same records in .las. Damaged ones are refused.
cat >in/make.py <<'P'
import random, struct
from laz_files import *
def records(point_format, count, wild):
    """A strip of ground whose numbers repeat, change a little, and jump."""
    r, out = random.Random(point_format), []
    z, time, intensity, angle, source, kind, user, infrared, channel, flags = 0, 3e5, 120, 0, 1, 2, 0, 7, 0, 0
    number = returns = 1
    color, extra = [100, 200, 300], [7, 0, 0, 9]
    new = point_format >= 6
    for k in range(count):
        x, y = k % 60 * 100 + r.choice((0, 0, 1, -2, 30)), k // 60 * 100 + r.choice((0, 0, 0, 5))
        z = (r.choice((z, z, z + 1, z - 7, r.randrange(3000))) + 2**31) % 2**32 - 2**31
        if wild and r.random() < 0.1:
            z = r.choice((0, -2**31))
        if wild and r.random() < 0.1:
            x, y, z = [r.randrange(-2**e, 2**e) for e in (r.randrange(1, 32), 31, 27)]
        if r.random() < 0.6:
            time += r.choice((1e-6, 1e-6, 2e-6, 9e-6, 1e-4, -3e-6, -2e-5, 0.01, 0.5, 1e-6 * r.randrange(600)))
        if r.random() < 0.05:
            time = r.choice((1e5, 2e5, 3e5, 4e5, -3e9, 7.5e8)) + k * 1e-6
        if r.random() < 0.3: intensity = r.choice((120, 121, r.randrange(65536)))
        if r.random() < 0.4: number, returns = r.randrange(16 if new else 8), r.randrange(16 if new else 8)
        if r.random() < 0.2: angle = r.randrange(-30000, 30000) if new else r.randrange(-90, 90)
        if r.random() < 0.1: source = r.randrange(65536)
        if r.random() < 0.2: kind = r.randrange(256)
        if r.random() < 0.1: user = r.randrange(256)
        if r.random() < 0.1: channel = r.randrange(4)
        if r.random() < 0.1: flags = r.randrange(64)
        if r.random() < 0.5: color = r.choice((color, [min(65535, c + r.randrange(3)) for c in color], [r.randrange(65536)] * 3, [r.randrange(65536) for _ in color]))
        if r.random() < 0.3: infrared = r.randrange(65536)
        if r.random() < 0.3: extra = [7, r.randrange(256), r.randrange(256), 9]
        if new:
            record = struct.pack("<3iHBBBBhHd", x, y, z, intensity, number | returns << 4, flags & 15 | channel << 4 | (flags & 48) << 2, kind, user, angle, source, time)
        else:
            record = struct.pack("<3iHBBbBH", x, y, z, intensity, number | returns << 3 | (flags & 3) << 6, kind, angle, user, source)
            record += struct.pack("<d", time) * (point_format in (1, 3, 4, 5))
        record += struct.pack("<3H", *color) * (point_format in (2, 3, 5, 7, 8)) + struct.pack("<H", infrared) * (point_format == 8) + bytes(29) * (point_format == 9)
        if point_format in (4, 5): record += struct.pack("<BQI4f", user, k * r.choice((60, 60, 2**33)), r.choice((60, 60, 99)), k % 7, 0, 1, r.random())
        out.append(record + bytes(extra))
    return out
def extra(kind, options, name):
    return struct.pack("<HBB32s156x", 0, kind, options, name)
spec = (b"LASF_Spec", 4, extra(0, 1, b"") + extra(3, 0, b"amplitude"))
for point_format in (0, 1, 2, 3, 4, 5, 6, 7, 8, 9):
    some = records(point_format, 1500, False)
    las("in/f%d.las" % point_format, point_format, some, blocks=[spec])
    laz("in/f%d.laz" % point_format, point_format, some, 400, blocks=[spec])
    laz("in/f%d.copc.laz" % point_format, point_format, some, [1, 2, 700, 797], blocks=[spec], version=4, table_at_end=True)
    if point_format < 6: laz("in/f%d.old.laz" % point_format, point_format, some, 1500, blocks=[spec], version=1)
for point_format in (3, 8):
    some = records(point_format, 4000, True)
    las("in/wild%d.las" % point_format, point_format, some)
    laz("in/wild%d.laz" % point_format, point_format, some, 4000)
    if point_format < 6: laz("in/old.laz", point_format, some, 4000, version=1)
same = [records(7, 1, False)[0]] * 20000 # nothing changes: the layers of most numbers are empty, the rest has 0.01 bits a point
las("in/same.las", 7, same)
laz("in/same.laz", 7, same, 20000)
some = records(6, 900, False)
def put(at, *what): return lambda whole: whole[:at] + bytes(what) + whole[at + len(what):]
def item(at, value): return lambda whole: put(whole.index(b"laszip encoded") - 2 + 54 + at, *value)(whole) # in the block of LASzip
points = lambda whole: struct.unpack_from("<I", whole, 96)[0]
for name, damage in {"cut": lambda whole: whole[:-300], "begin": lambda whole: whole[:points(whole) + 10], "way": item(0, (7, 0)),
                     "unwritten": lambda whole: put(points(whole), *struct.pack("<q", points(whole)))(whole),
                     "table": lambda whole: put(points(whole), *struct.pack("<q", points(whole) + 100))(whole),
                     "layer": lambda whole: put(points(whole) + 8 + 34 + 20, 255, 255)(whole),
                     "version": item(38, (1, 0)), "items": item(34, (9, 0)), "many": lambda whole: put(247, 255, 255, 255, 255)(whole),
                     "no_block": lambda whole: whole.replace(b"laszip encoded", b"laszip encodeX")}.items():
    laz("in/%s.laz" % name, 6, some, 300, damage=damage)
some = records(1, 900, False)
laz("in/flip.laz", 1, some, 300, damage=lambda whole: put(points(whole) + 8 + 32 + 500, whole[points(whole) + 540] ^ 255)(whole))
laz("in/longer.laz", 1, some, 300, behind=b"123") # bytes that no point needs
P
python3 in/make.py || exit 1
pair=0
same() { # LAZ LAS OPTION..: the same points and columns; pictures are compared below
    local f
    pair=$((pair + 1))
    for f in $1.laz $2.las; do
        isorender "in/$f" $pair.${f##*.}.png --points $pair.${f##*.}.ply --resolution 160x160 --camera iso --quiet "${@:3}" || exit 1
        isorender --info "in/$f" 2>&1 | sed "s|in/$f||" >$pair.${f##*.}.info
    done
    cmp $pair.laz.ply $pair.las.ply && cmp $pair.laz.info $pair.las.info || { echo "$@"; exit 1; }
}
for f in 0 1 2 3 4 5 6 7 8 9; do
    same f$f f$f --threads 1
    same f$f.copc f$f --threads 3
    [ $f -gt 5 ] || same f$f.old f$f
done
for f in 3 8; do
    for column in $(grep -o 'gps_time: \|intensity\|amplitude\|classification\|return_number' $pair.las.info | tr -d ': '); do
        same f$f f$f --color-by $column
        [ $f = 8 ] || same f$f.old f$f --color-by $column
    done
done
grep -q 'amplitude: [0-9]* .. 6[0-9]*' $pair.laz.info || exit 1
same wild3 wild3
same old wild3
same wild8 wild8
same same same
python3 -c 'from check import *
import sys
for k in range(1, int(sys.argv[1]) + 1):
    expect(Png("%d.laz.png" % k).rows == Png("%d.las.png" % k).rows, k)' $pair || exit 1
python3 -c 'import os, sys; sys.exit(os.path.getsize("in/same.laz") * 200 > os.path.getsize("in/same.las"))' || exit 1
cp in/f6.laz in/no_extension
isorender in/no_extension c.png --quiet --resolution 40x40 || exit 1
isorender_refuses 3 'in/cut.laz: truncated: its chunk table is missing' in/cut.laz
isorender_refuses 3 'in/begin.laz: truncated: its points are missing' in/begin.laz
isorender_refuses 3 'in/unwritten.laz: damaged: its chunk table was not written' in/unwritten.laz
isorender_refuses 3 'in/table.laz: damaged: its chunk table' in/table.laz
isorender_refuses 3 'in/layer.laz: damaged: chunk 1 of 3' in/layer.laz
isorender_refuses 3 'in/flip.laz: damaged: chunk 1 of 3' in/flip.laz
isorender_refuses 3 'in/longer.laz: damaged: chunk 1 of 3' in/longer.laz
isorender_refuses 3 'in/many.laz: damaged: its chunk table has not all points' in/many.laz
isorender_refuses 3 'in/items.laz: damaged: what its points consist of' in/items.laz
isorender_refuses 3 'in/no_block.laz: damaged: nothing says how its points are compressed (LAZ)' in/no_block.laz
isorender_refuses 3 'in/way.laz: compressor 7 with coder 0 of LAZ is not read: pdal translate' in/way.laz
isorender_refuses 3 'in/version.laz: version 1 of compressed points (LAZ) is not read: pdal translate' in/version.laz
