# lines and glyphs fill the picture as they are seen, also a few that lie on one side of the world's origin
cat >in/cell.swc <<'P'
1 1 0 0 0 5 -1
2 3 9 0 4 0.5 1
3 3 43 0 19 0.5 2
P
printf 'x,y,z,radius\n0,0,0,1\n10,0,0,1\n' >in/two.csv
printf 'v 2 0 3\nv 30 0 9\nv 31 0 25\nl 1 2 3\n' >in/line.obj
for style in tube ribbon; do isorender --lines in/line.obj $style.png --line-style $style --tube-radius 2 --camera front --resolution 200x200 --quiet; done
isorender in/cell.swc cell.png --resolution 200x200 --quiet
isorender in/two.csv two.png --resolution 200x200 --quiet
isorender in/two.csv parallel.png --orthographic --resolution 200x200 --quiet
isorender in/two.csv turned.png --azimuth 40 --elevation 20 --resolution 200x200 --quiet
python3 - <<'P'
from check import *
for name in "tube ribbon cell two parallel turned".split():
    rows = Png(name + ".png").rows
    ys = [y for y, row in enumerate(rows) if any(pixel[:3] != (255, 255, 255) for pixel in row)]
    xs = [x for y in ys for x, pixel in enumerate(rows[y]) if pixel[:3] != (255, 255, 255)]
    x0, y0, x1, y1 = min(xs), ys[0], max(xs) + 1, ys[-1] + 1
    expect(abs(x0 + x1 - 200) <= 3 and abs(y0 + y1 - 200) <= 3, name, x0, y0, x1, y1)
    expect(160 <= max(x1 - x0, y1 - y0) <= 186, name, x0, y0, x1, y1)
P
