# in glass --opacity is what each surface on the way takes away (eq. 11 of Zhang and Pajarola 2006): .5 twice leaves a quarter of
# the light, and rays followed through the solid do not count surfaces
python3 -c 'from check import *; from struct import pack; import zlib
def chunk(kind, body): return pack(">I", len(body)) + kind + body + pack(">I", zlib.crc32(kind + body))
rows = (b"\0" + b"\xff\xff\xff" * 8) * 4
open("in/white.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", pack(">IIBBBBB", 8, 4, 8, 2, 0, 0, 0)) +
                                 chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))'
for method in exact raycast splats; do
    isorender scene:sphere:32 $method.png --ior 1.0001 --refraction layers --opacity 0.5 --method $method --environment in/white.png \
        --resolution 41x41 --quiet
done
isorender scene:sphere:32 single.png --ior 1.0001 --refraction single --opacity 0.5 --environment in/white.png --resolution 41x41 --quiet
python3 - <<'P'
from check import *
for name, level in (("exact", 137), ("raycast", 137), ("splats", 137), ("single", 188)):  # sRGB of 1/4 and of 1/2
    seen = Png(name + ".png").rows[20][20]
    expect(all(abs(seen[k] - level) <= 1 for k in range(3)), name, seen)
P
isorender_refuses 2 "needs --refraction layers, single or none" scene:sphere:16 --ior 1.5 --opacity 0.5
isorender_refuses 2 "needs --refraction layers, single or none" scene:sphere:16 --ior 1.5 --opacity 0.5 --refraction two-sided
