# Occlusion and shadows beside translucent surfaces, and by and on lines and glyphs: what is opaque is darker, what is translucent
# is as it was; exact as raycast; the same bytes for threads, instruction sets and scene files. What a method cannot do is refused.
python3 - <<'P'
# Three parallel lines and one across them, and balls in a row, within the torus of 48 mm and beside it.
line = lambda y: [(x, y, 24) for x in range(4, 45, 4)]
points = [p for y in (20, 24, 28) for p in line(y)] + [(22, y, 31) for y in range(4, 45, 4)]
with open("in/lines.vtk", "w") as f:
    f.write("# vtk DataFile Version 3.0\nlines\nASCII\nDATASET POLYDATA\nPOINTS %d float\n" % len(points))
    f.writelines("%g %g %g\n" % p for p in points)
    n = len(points) // 4
    f.write("LINES 4 %d\n" % (4 * (n + 1)))
    f.writelines(" ".join(map(str, [n] + list(range(i * n, i * n + n)))) + "\n" for i in range(4))
with open("in/balls.xyz", "w") as f:
    f.write("9\nballs\n" + "".join("C %g 24 %g\n" % (8 + 4 * i, 24 + i % 2) for i in range(9)))
P
draw() { isorender "${@:2}" "$1.png" --resolution 160x160 --camera top --quiet --json="$1.json" || { echo "failed: $1"; exit 1; }; }
lines="--lines in/lines.vtk --tube-radius 2.2"
see="scene:torus:48 --opacity 0.3 $lines"
draw see $see
for light in occlusion shadow; do
    draw see-$light $see --$light
    draw see-$light-same $see --$light --threads 1
    ISO_CPU=generic draw see-$light-generic $see --$light
done
for method in exact raycast; do
    draw two-$method scene:head:64 --isovalue 1,-1 --opacity 0.2,1 --occlusion=20 --shadow --samples 1 --method $method
done
isocompare images two-raycast.png two-exact.png >same || exit 1
awk '/^pixels_differing/ { found = 1; if ($2 > 2) exit 1 } END { if (!found) exit 1 }' same || { cat same; exit 1; }
draw two-plain scene:head:64 --isovalue 1,-1 --opacity 0.2,1 --samples 1
draw solid scene:torus:48 $lines --occlusion=6
draw solid-plain scene:torus:48 $lines
draw alone --lines in/lines.vtk --tube-radius 2.2 --occlusion=6 --save-scene alone.scene.json
draw alone-plain --lines in/lines.vtk --tube-radius 2.2
isorender alone.scene.json again.png --quiet && cmp alone.png again.png || exit 1
draw glyphs --glyphs in/balls.xyz --glyph-radius 2.4 --occlusion=8
draw glyphs-plain --glyphs in/balls.xyz --glyph-radius 2.4
refuses 2 "splats cannot draw --occlusion beside --opacity below 1: that needs exact or raycast" \
    isorender scene:torus:32 bad.png --opacity 0.5 --occlusion --method splats
refuses 2 "--outline is of opaque surfaces: it cannot be combined with --opacity below 1" \
    isorender scene:torus:32 bad.png --opacity 0.5 --occlusion --outline
isorender scene:torus:32 clear.png --opacity 0.5 --occlusion 2>notes
grep -q "note: --occlusion is of opaque surfaces of volumes, lines, glyphs and meshes: there is none" notes || exit 1
python3 - <<'P'
from check import *
def hashes(name): return report(name + ".json")["image"]["hash"]
def darker(lit, plain):
    """How many pixels are darker, and lighter by more than rounding."""
    a, b = (sum((row for row in Png(n + ".png").rows), []) for n in (lit, plain))
    sums = [sum(p[:3]) - sum(q[:3]) for p, q in zip(a, b)]
    return sum(s < -9 for s in sums), sum(s > 3 for s in sums)
for light in "occlusion", "shadow":
    expect(hashes("see-" + light) == hashes(f"see-{light}-same") == hashes(f"see-{light}-generic"), light)
for lit, plain in (("see-occlusion", "see"), ("see-shadow", "see"), ("two-exact", "two-plain"), ("solid", "solid-plain"),
                   ("alone", "alone-plain"), ("glyphs", "glyphs-plain")):
    less, more = darker(lit, plain)
    expect(less > 100 and more == 0, lit, less, more)
P
