# A red sky over a blue ground: what is seen above and below the ball, and upside down in it. Not twice as wide as high: said.
python3 - <<'P'
import struct, zlib
def chunk(kind, body): return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
rows = b"".join(b"\0" + (b"\xff\0\0" if y < 8 else b"\0\0\xff") * 24 for y in range(16))
open("in/sky.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 24, 16, 8, 2, 0, 0, 0)) +
                               chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
P
isorender scene:sphere:32 ball.png --ior 1.5 --environment in/sky.png --resolution 60x60 2>said.txt
grep -q "note: in/sky.png: 24x16 pixels, not twice as wide as high" said.txt
isorender scene:sphere:32 side.png --ior 1.5 --environment in/sky.png --resolution 60x60 --up +x --quiet
python3 - <<'P'
from check import *
red, blue = lambda p: p[0] > 150 > p[2], lambda p: p[2] > 150 > p[0]
for name in ("ball.png", "side.png"):
    ball = Png(name)
    expect(red(ball.rows[0][30]) and blue(ball.rows[59][30]), name, ball.rows[0][30], ball.rows[59][30])
    expect(blue(ball.rows[15][30]) and red(ball.rows[45][30]), name, ball.rows[15][30], ball.rows[45][30])
P
