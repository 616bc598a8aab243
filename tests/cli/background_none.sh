isorender scene:sphere:32 a.png --resolution 64x64 --samples 4 --no-background --quiet
isorender scene:sphere:32 b.png --resolution 64x64 --background 102030 --quiet
python3 - <<'P'
from check import *
a, b = Png("a.png"), Png("b.png")
expect(a.channels == 4 and a.rows[0][0][3] == 0 and a.rows[32][32][3] == 255, a.rows[0][0], a.rows[32][32])
expect(any(0 < p[3] < 255 for p in a.pixels()), "no edge is smooth")
expect(b.channels == 3 and b.rows[0][0] == (0x10, 0x20, 0x30, 255), b.rows[0][0])
P
