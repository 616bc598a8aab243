# A picture's scale: --mm-per-pixel, what --json and the PNG say of it, framing, and what cannot be combined.
python3 -c 'from check import *; ball("in/ball.mha", side=48, radius=10.0, header="ElementSpacing = 2 2 2\n")' # 20 mm
isorender in/ball.mha out.png --isovalue 500 --mm-per-pixel 0.5 --resolution 200x160 --background none --json=a.json --quiet
isorender in/ball.mha tight.png --isovalue 500 --fit tight --margin 10% --camera iso --resolution 200x160 --background none --quiet
isorender in/ball.mha edge.png --isovalue 500 --fit tight --margin 0 --orthographic --resolution 160x200 --background none --json=e.json --quiet
isorender in/ball.mha plain.png --isovalue 500 --resolution 64x64 --quiet --json=p.json
isorender in/ball.mha marked.png --isovalue 500 --orthographic --scale-bar --orientation-marker --resolution 300x300 --json=m.json --quiet
isorender in/ball.mha marked1.png --isovalue 500 --orthographic --scale-bar --orientation-marker --resolution 300x300 --threads 1 --quiet
isorender in/ball.mha bare.png --isovalue 500 --orthographic --resolution 300x300 --quiet
# With --mm-per-pixel, tight decides only what is in the middle: of a solid that is no box, what is seen.
python3 -c 'from check import *; volume("in/half.mha", (24, 24, 24), lambda x, y, z: 11.0 - x - y - z + 12 if min(x, y, z) > 1 else 0.0)'
isorender in/half.mha half.png --isovalue 5.5 --mm-per-pixel 0.5 --camera iso --resolution 160x160 --background none --json=h.json --quiet
isorender in/half.mha box.png --isovalue 5.5 --mm-per-pixel 0.5 --fit box --camera iso --resolution 160x160 --background none --quiet
isorender --help all | tr -s ' \n' ' ' | grep -q 'with --mm-per-pixel, which sets the scale, what is in the middle of the picture'
isorender in/ball.mha turn.png --isovalue 500 --fit tight --turntable 3 --resolution 100x100 --background none --quiet
cmp marked.png marked1.png
python3 - <<'P'
from check import *
import struct
def covered(name):
    png = Png(name)
    pixels = png.pixels()
    xs = [i % png.width for i, p in enumerate(pixels) if p[3]]
    ys = [i // png.width for i, p in enumerate(pixels) if p[3]]
    return min(xs), png.width - 1 - max(xs), min(ys), png.height - 1 - max(ys)
def density(name):
    data = open(name, "rb").read()
    at = data.find(b"pHYs")
    return struct.unpack_from(">IIB", data, at + 4) if at > 0 else None
left, right, top, bottom = covered("out.png")
expect(abs(200 - left - right - 80) <= 1 and abs(160 - top - bottom - 80) <= 1, left, right, top, bottom)
expect(density("out.png") == (2000, 2000, 1), density("out.png"))
camera = report("a.json")["camera"]
expect(camera["mm_per_pixel"] == 0.5 and camera["orthographic"] is True, camera)
expect(density("plain.png") is None and report("p.json")["camera"]["mm_per_pixel"] is None)
left, right, top, bottom = covered("tight.png")
expect(top in (15, 16, 17) and abs(top - bottom) <= 1 and abs(left - right) <= 1 and left > 16, left, right, top, bottom)
left, right, top, bottom = covered("edge.png")
expect(left <= 1 and right <= 1 and abs(top - bottom) <= 1, left, right, top, bottom)
mm = report("e.json")["camera"]["mm_per_pixel"]
expect(abs(mm - 40 / 160) < 0.002 and abs(density("edge.png")[0] - 1000 / mm) <= 0.5, mm)
left, right, top, bottom = covered("half.png")
expect(abs(left - right) <= 1 and abs(top - bottom) <= 1 and report("h.json")["camera"]["mm_per_pixel"] == 0.5, left, right, top, bottom)
left, right, top, bottom = covered("box.png")
expect(abs(left - right) > 4 or abs(top - bottom) > 4, left, right, top, bottom)
mark = report("m.json")
expect(mark["scale_bar_mm"] in (1, 2, 5, 10, 20, 50), mark)
a, b = Png("marked.png").pixels(), Png("bare.png").pixels()
corner = [i for i in range(len(a)) if a[i] != b[i]]
expect(all(i // 300 > 170 for i in corner) and any(i % 300 < 60 for i in corner) and any(i % 300 > 240 for i in corner))
sides = [covered("turn_%03d.png" % n) for n in range(3)]
expect(max(abs(s[k] - sides[0][k]) for s in sides for k in range(4)) <= 1 and min(sides[0]) in (3, 4), sides)
P
# Of a file without a unit --mm-per-pixel speaks of mm, or of what --unit says that its lengths are in.
printf '0 0 0\n9 0 0\n9 0 9\n0 0 9\n' >in/dots.xyz
dots() { isorender in/dots.xyz "$1.png" --radius 2 --mm-per-pixel 0.1 --scale-bar --resolution 200x200 --json="$1.json" --quiet "${@:2}"; }
dots dots_mm && dots dots_um --unit um && dots dots_cm --unit cm
python3 - <<'P'
from check import *
mm, um, cm = (report("dots_%s.json" % unit) for unit in ("mm", "um", "cm"))
expect(mm["scale_bar_mm"] == um["scale_bar"] == cm["scale_bar"] == 5, mm, um, cm)
expect("scale_bar_mm" not in um and "scale_bar_mm" not in cm)
P
fails() { refuses 2 "$1" isorender in/ball.mha bad.png --isovalue 500 "${@:2}"; }
fails "--scale-bar needs --orthographic or --mm-per-pixel" --scale-bar
fails "--mm-per-pixel and --zoom both set the scale" --mm-per-pixel 1 --zoom 2
fails "--mm-per-pixel and --margin both set the scale" --mm-per-pixel 1 --margin 5%
fails "--fit tight frames the surface, which --camera-position does not" --fit tight --camera-position 0,-100,0
fails "--fit tight chooses the focal point" --fit tight --camera-focal-point 0,0,0
fails "'50%' is not a part of the picture" --margin 50%
fails "option --mm-per-pixel" --mm-per-pixel 0
