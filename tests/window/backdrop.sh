#!/bin/bash
# A reference picture behind the sculpture in a real window under Xvfb: where it stands, its opacity in the panel, kept beside the
# strokes. backdrop.sh BIN TOOLS: the folders of the programs and of the tests' own programs. Exit status 77: skipped, as
# something needed is missing.
set -u
. "$(dirname "$0")/support.sh"
require_window
open_display
cd "$work" || exit 1

# A picture of 40 x 30 pixels: red on the left, blue on the right, the lowest third green.
make_picture() { # NAME
    python3 - "$1" <<'PYTHON'
import struct, sys, zlib
rows = b"".join(b"\0" + b"".join(b"\0\xc0\0" if y >= 20 else b"\xc0\0\0" if x < 20 else b"\0\0\xc0" for x in range(40)) for y in range(30))
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
open(sys.argv[1], "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 40, 30, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
PYTHON
}
# shows PICTURE R G B BOX: whether the picture has much of a colour there
shows() { look color "$1.png" "$2" "$3" "$4" "$5" 500 >/dev/null; }
kept() { cat "$journal.picture" 2>/dev/null; }

make_picture face.png
start --reference face.png,y,120
key shift+1
front() { picture front && shows front 134 18 20 0,200,150,400 && shows front 20 18 134 830,200,970,400 && shows front 19 134 20 0,650,150,700; }
until_ "the picture, from the front" front
# (the ball is drawn over it)
shows front 134 18 20 400,300,480,500 && fail "the picture is in front of the ball"
key ctrl+1
back() { picture back && shows back 134 18 20 830,200,970,400 && shows back 20 18 134 0,200,150,400; }
until_ "the picture from behind, mirrored" back
key shift+3
edge() { picture edge && ! shows edge 134 18 20 0,0,976,800 && ! shows edge 20 18 134 0,0,976,800; }
until_ "nothing of it from the right" edge
key shift+1
until_ "from the front again" front

# ---- kept beside the strokes, with a checksum
stroke 640 400 60 10
until_ "a file beside the strokes" test -s "$journal.picture"
grep -q "^[0-9a-f]\{8\} y 120 .* 1 /.*/face.png$" "$journal.picture" || fail "$(kept)"
# its box in the panel hides it and shows it again
picture drawn
hides() { press 24 498; picture hidden; differ drawn hidden && ! shows hidden 134 18 20 0,200,150,400; }
until_ "no picture" hides
until_ "that it is hidden, beside the strokes" grep -q " 0 /" "$journal.picture"
returns() { press 24 498; picture shown; cmp -s "$work/drawn.png" "$work/shown.png"; }
until_ "the picture again" returns
until_ "that it is shown" grep -q " 1 /" "$journal.picture"
cp "$journal" "$work/again.strokes"
cp "$journal.picture" "$work/again.strokes.picture"
"$bin/isosculpt" --replay again.strokes --headless --quiet --output with.ply || fail "--replay with a picture"

# ---- opened again with the strokes; a picture that is another one is shown, and said
stop
start again.strokes
key shift+1 f
again() { picture again && shows again 134 18 20 0,200,150,400; }
until_ "the picture of the strokes" again
stop
sed -i 's/^[0-9a-f]\{8\} y/00000000 y/' again.strokes.picture
start again.strokes
until_ "what has changed" says "The reference picture has changed since: "
stop
# a photograph: a JPEG, by an ending in capitals
if "$bin/isorender" again.strokes photo.jpg --quiet --background "#c00000" --resolution 40x30 2>said; then
    mv photo.jpg photo.JPG
    start --reference photo.JPG,y,120
    key shift+1
    photo() { picture photo && shows photo 134 18 20 0,200,150,400; }
    until_ "the photograph" photo
    stop
else
    grep -q "built without libjpeg" said || fail "$(cat said)"
fi
rm face.png
start again.strokes
until_ "what is missing" says "No reference picture: "
stop
# damaged files beside strokes are no pictures
for text in "" "isopoint picture 1" "isopoint picture 2
0 y 1 1 0 0 0 1 a.png" "isopoint picture 1
0 w 1 1 0 0 0 1 a.png" "isopoint picture 1
0 y nan 1 0 0 0 1 a.png" "isopoint picture 1
0 y 1 7 0 0 0 1 a.png"; do
    printf '%s\n' "$text" >again.strokes.picture
    start again.strokes
    until_ "the strokes" title_is 'again'
    says "picture" && fail "a damaged file beside strokes is used: $text"
    stop
done

# ---- refused in one line
for wrong in face.png,y face.png,w,1 face.png,y,0 face.png,y,-1 face.png,y,1x; do
    "$bin/isosculpt" --reference "$wrong" 2>said && fail "$wrong is not refused"
    [ "$(wc -l <said)" = 1 ] || fail "$wrong: $(cat said)"
done
"$bin/isosculpt" --replay again.strokes --headless --draw --reference face.png,y,9 2>said && fail "a picture without a window"
grep -q "for a window" said || fail "$(cat said)"
echo "passed"
