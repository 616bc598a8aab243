#!/bin/bash
# A picture of heights in a real window under Xvfb: given as a stamp, it weighs a brush's touches; turned along the stroke and left
# out in the panel; the journal replays without it. alpha.sh BIN TOOLS: the folders of the programs and of the tests' own
# programs. Exit status 77: skipped, as something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1
last() { grep '"event":"begin"' "$journal" | tail -1; }
python3 - <<'P'
import struct, zlib

def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

rows = b"".join(b"\0" + bytes(255 * ((x - 32) ** 2 + (y - 32) ** 2 < 200 or y < 8) for x in range(64)) for y in range(64))
with open("heights.png", "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 64, 64, 8, 0, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows))
               + chunk(b"IEND", b""))
P
start --stamp heights.png
has_picture() { grep -q '"name":"heights.png","heights":' "$journal"; }
until_ "the picture in the journal" has_picture
picture ball
stroke 640 400 1 0
last | grep -q '"tool":"inflate".*"alpha":"fixed"' || fail "no alpha: $(last | cut -c1-400)"
for repeat in 1 2 3 4 5 6 7 8; do stroke 640 400 1 0; done
picture stamped
differ ball stamped || fail "the stamp does nothing"
# turned along the stroke, and left out: the second and third of the list
turned() { press 100 246; press 60 "$1"; stroke 700 300 40 40; last | grep -q "$2"; }
until_ "along the stroke" turned 318 '"alpha":"follows"'
plain() { turned 274 '"pressure_strength":false}' && ! last | grep -q alpha; }
until_ "no picture" plain
# a tool that it does not weigh has none
key 1
stroke 600 300 20 0
last | grep -q '"tool":"add"' || fail "no add"
last | grep -q alpha && fail "add has an alpha"
rm heights.png
cp "$journal" alpha.strokes
"$bin/isosculpt" --replay alpha.strokes --headless --quiet --output one.ply --threads 1
"$bin/isosculpt" --replay alpha.strokes --headless --quiet --output many.ply
cmp one.ply many.ply || fail "another number of threads gives another surface"
echo "passed"
