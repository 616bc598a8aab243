# Points that do not fit into --max-memory lie in temporary files, and what comes out has the same bytes: for points that are drawn
# as they are stored, for those whose normals and radii are estimated, for text, and by methods that list them again.
[ "$(stat -f -c %T "$TMPDIR")" != tmpfs ] || { echo "skipped: TMPDIR lies in memory (tmpfs)"; exit 77; }
python3 - <<'P'
import random, struct
random.seed(7)
COUNT = 300000
with open("in/stored.ply", "wb") as stored, open("in/bare.ply", "wb") as bare, open("in/text.xyz", "w") as text:
    names = ["float " + n for n in "x y z nx ny nz".split()] + ["uchar " + n for n in "red green blue".split()]
    for file, used in ((stored, names), (bare, names[:3])):
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % COUNT
                    + "".join("property %s\n" % n for n in used) + "end_header\n").encode())
    for i in range(COUNT):
        v = [random.gauss(0, 1) for _ in range(3)]
        length = sum(x * x for x in v) ** 0.5
        v = [x / length for x in v]
        stored.write(struct.pack("<6f3B", *[20 * x for x in v], *v, i % 256, 100, 200))
        bare.write(struct.pack("<3f", *[20 * x for x in v]))
        text.write("%.4f %.4f %.4f\n" % tuple(20 * x for x in v))
P
draw() { # draw NAME LIMIT FILE [options]: the picture in memory, and with the limit
    isorender "$3" "$1.png" --resolution 200x200 --json="$1.json" --quiet "${@:4}"
    isorender "$3" "$1-limited.png" --resolution 200x200 --json="$1-limited.json" --quiet "${@:4}" --max-memory "$2"
    cmp "$1.png" "$1-limited.png"
}
draw stored 10M in/stored.ply --radius 0.2
draw bare 12M in/bare.ply
draw text 12M in/text.xyz
draw groups 16M in/stored.ply --radius 0.2 --method splats --reconstruction groups
draw discs 12M in/stored.ply --method discs --lod 1
isorender in/bare.ply --no-image --points a.ply --quiet
isorender in/bare.ply --no-image --points b.ply --quiet --max-memory 12M
cmp a.ply b.ply
[ -z "$(ls "$TMPDIR")" ]
python3 - <<'P'
from check import *
for name in "stored bare text groups discs".split():
    whole, limited = report(name + ".json"), report(name + "-limited.json")
    expect(whole["primitives"]["temporary_file_bytes"] == 0, name, whole["primitives"])
    expect(limited["primitives"]["temporary_file_bytes"] > 1 << 20, name, limited["primitives"])
P
# Where there is no room for the files the limit holds. Small blocks of memory never lie in files.
TMPDIR=/nonexistent isorender_refuses 5 'limit is 13 MB (--max-memory); temporary files cannot be made in /nonexistent (TMPDIR): No such file or directory' in/bare.ply --max-memory 12M --resolution 64x64
if [ "$(stat -f -c %T /dev/shm)" = tmpfs ]; then
    TMPDIR=/dev/shm isorender_refuses 5 'in memory (tmpfs)' in/bare.ply --max-memory 12M --resolution 64x64
fi
isorender_refuses 5 'limit is 1 MB' in/bare.ply --max-memory 1M --resolution 64x64
