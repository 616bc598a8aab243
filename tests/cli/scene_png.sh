isorender scene:torus:64 --resolution 120x80 2>log
grep -q 'wrote torus.png' log
python3 - <<'P'
from check import *
png = Png("torus.png")
expect((png.width, png.height, png.channels) == (120, 80, 3), png.width, png.height, png.channels)
expect(png.texts["Software"].startswith("isorender "), png.texts)
expect(png.texts["Comment"] == "isorender torus --resolution=120x80", png.texts)
colors = set(png.pixels())
expect((255, 255, 255, 255) in colors and len(colors) > 50, len(colors))
expect(png.rows[0][0] == png.rows[79][119] == (255, 255, 255, 255), "corners")
P
