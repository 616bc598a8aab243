# Ambient occlusion, shadows, outlines and looks: other pictures of the same samples, the same for threads, instruction sets and
# strips, in all methods; refused where they cannot be; a look is the options that it stands for.
draw() { isorender "${@:2}" "$1.png" --quiet --resolution 160x160 --json="$1.json"; }
scene="scene:head:64 --azimuth 30"
methods="mesh raycast discs points pullpush splats"
# Discs of edge points, which face the eye, have so many steps here that their outlines are twice as dark.
of() { [ "$1" != points ] && echo "--method $1" || echo "--method points --primitive foot"; }
draw plain $scene
for method in $methods; do draw plain-$method $scene $(of $method) --samples 4; done
for light in occlusion shadow outline; do
    draw $light $scene --$light
    draw $light-same $scene --$light --threads 1
    ISO_CPU=generic draw $light-generic $scene --$light
    for method in $methods; do draw $light-$method $scene --$light $(of $method) --samples 4; done
    refuses 2 "opacity below 1" isorender scene:torus:32 bad.png --$light --opacity 0.5 --method splats
    refuses 2 "it cannot be combined with --ior" isorender scene:torus:32 bad.png --$light --ior 1.5
    refuses 2 "needs depths and normals of the whole picture" isorender scene:torus:32 --part 1/2 -o bad.isokeys --$light
done
draw near $scene --occlusion=2
draw far $scene --occlusion=1e9
draw below $scene --occlusion=1e-9
draw wide $scene --outline=3
draw dark $scene --outline=3 --background 000000
for wrong in 0 -3 x nan 1e99; do refuses 2 "is not a range in mm, above 0" isorender scene:torus:32 bad.png --occlusion=$wrong; done
for wrong in 0 -3 x 17; do refuses 2 "is not a width in pixels" isorender scene:torus:32 bad.png --outline=$wrong; done
refuses 2 "lights by depths alone" isorender scene:torus:32 bad.png --occlusion --shading edl

# Looks: what they stand for is printed, drawn again to the same bytes, and gives way to what is given.
for look in paper studio xray clay; do
    draw look-$look scene:torus:48 --look $look --save-scene $look.json
    isorender $look.json again-$look.png --quiet
    cmp look-$look.png again-$look.png || exit 1
done
draw given scene:torus:48 --look studio --background FF0000 --samples 1
isorender scene:torus:48 --look paper --save-scene - printed.png --quiet >printed.json || exit 1
isorender scene:torus:48 --points in/p.ply --no-image --quiet
isorender in/p.ply p.png --look paper 2>notes
grep -q "note: --occlusion is of opaque surfaces of volumes, lines, glyphs and meshes: there is none in the picture" notes || exit 1
python3 - <<'P'
import json
from check import *
names = "plain occlusion shadow outline near far below wide dark".split()
r = {n: report(n + ".json") for n in names}
hashes = [r[n]["image"]["hash"] for n in names]
expect(len(set(hashes)) == len(hashes) - 1 and r["below"]["image"]["hash"] == r["plain"]["image"]["hash"], hashes)
for light in "occlusion", "shadow", "outline":
    same, generic = (report(f"{light}-{n}.json") for n in ("same", "generic"))
    expect(r[light]["image"]["hash"] == same["image"]["hash"] == generic["image"]["hash"], light)

def mean(name):
    rows = Png(name + ".png").rows
    return sum(sum(p[:3]) for row in rows for p in row) / len(rows) / len(rows[0]) / 3

plain = mean("plain")
for light in "occlusion", "shadow", "outline":
    expect(mean(light) < plain - 0.5, light, mean(light), plain)
    for method in "mesh", "raycast", "discs", "points", "pullpush", "splats":
        darker = mean(f"plain-{method}") - mean(f"{light}-{method}")
        expect(0.5 < darker / (plain - mean(light)) < 2, light, method, darker, plain - mean(light))
expect(mean("far") < mean("occlusion") < mean("near") < plain, mean("far"), mean("occlusion"), mean("near"), plain)
expect(mean("wide") < mean("outline"), mean("wide"), mean("outline"))
expect(Png("given.png").rows[0][0][:3] == (255, 0, 0), Png("given.png").rows[0][0])
options = {k: v for o in json.load(open("printed.json"))["options"] for k, v in o.items()}
expect({"occlusion", "outline", "background", "color", "samples"} <= set(options) and "look" not in options, options)
P
