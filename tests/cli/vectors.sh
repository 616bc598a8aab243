# volumes of vectors and tensors as glyphs and streamlines: counts, sizes, colours, spaces, and one line for each refusal
python3 - <<'P'
import math, struct
def mha(name, size, channels, value):
    with open(name, "wb") as f:
        f.write(("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                 "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = %d %d %d\nElementSpacing = 1 1 1\n"
                 "DimSize = %d %d %d\nElementNumberOfChannels = %d\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n"
                 % (*[-(n - 1) // 2 for n in size], *size, channels)).encode())
        for z in range(size[2]):
            for y in range(size[1]):
                for x in range(size[0]):
                    at = [c - (n - 1) / 2 for c, n in zip((x, y, z), size)]
                    f.write(struct.pack("<%df" % channels, *value(*at)))
mha("in/turn.mha", (21, 21, 5), 3, lambda x, y, z: (-y, x, 0))
mha("in/zero.mha", (3, 3, 3), 3, lambda x, y, z: (0, 0, 0))
mha("in/nan.mha", (3, 3, 3), 3, lambda x, y, z: (math.nan, 0, 0))
mha("in/two.mha", (3, 3, 3), 2, lambda x, y, z: (1, 1))
mha("in/tensors.mha", (5, 5, 5), 6, lambda x, y, z: (3, 0, 0, 2, 0, z + 1 if z < 2 else math.inf))
mha("in/flat.mha", (3, 3, 3), 6, lambda x, y, z: (1, 0, 0, 1, 0, 0))
P
isorender --glyphs in/turn.mha arrows.png --color-bar --json=arrows.json --quiet
isorender --glyphs in/turn.mha --glyph cone --every 5 --least 2 --glyph-color direction cones.png --json=cones.json --quiet
isorender --glyphs in/tensors.mha ellipsoids.png --json=ellipsoids.json 2>notes
grep -q "25 vectors are not finite\|25 tensors" notes && grep -q "not positive definite" notes
isorender --lines in/turn.mha --streamlines 20 --streamline-length 100 lines.png --json=lines.json --quiet
isorender --lines in/turn.mha --streamlines 20 --streamline-length 100 again.png --threads 1 --quiet
cmp lines.png again.png
isorender --lines in/turn.mha --streamlines 20 --streamline-seed 1 --color-by speed --range 0,5 other.png --quiet
isorender in/turn.mha --isovalue 2 --opacity 0.3 --lines in/turn.mha --tube-radius 0.2 --glyphs in/turn.mha both.png --json=both.json --quiet 2>&1
python3 - <<'P'
import json
arrows, cones, ellipsoids, lines, both = (json.load(open(n + ".json")) for n in ("arrows", "cones", "ellipsoids", "lines", "both"))
a = arrows["objects"][0]
assert a["glyphs"] == 21 * 21 * 5 - 5 and a["field"]["zero"] == 5 and a["field"]["every"] == 1, a
assert abs(a["field"]["scale_mm"] * 200 ** .5 - 1) < 1e-6 and a["range"] == [1, 200 ** .5 // 1e-6 * 1e-6] or abs(a["range"][1] - 200 ** .5) < 1e-5, a
c = cones["objects"][0]
assert c["glyphs"] == 24 and c["field"]["small"] == 0 and c["field"]["every"] == 5, c
e = ellipsoids["objects"][0]["field"]
assert e["components"] == 6 and e["missing"] == 25 and e["indefinite"] == 50, e
l = lines["objects"][0]
assert l["lines"] == 20 and sum(l["field"]["ends"].values()) == 40 and l["field"]["step_mm"] == .25, l
assert [o["path"] for o in both["objects"]] == ["in/turn.mha"] * 2
P
isorender --scene sphere:40 gradients.png --glyphs surface --every 8 --color-bar --json=gradients.json --quiet
isorender --scene sphere:40 --method discs --glyphs surface --glyph-color red --every 8 red.png --quiet
python3 - <<'P'
import json
o = json.load(open("gradients.json"))["objects"][0]
assert o["path"] == "surface" and 50 < o["glyphs"] < 125 and o["gradients"]["every"] == 8, o
assert o["range"][0] > 0 and o["gradients"]["points"] > 1000, o
P
isorender --info in/turn.mha >info 2>/dev/null
grep -q "if they are vectors: arrows (--glyphs), streamlines (--lines)" info
isorender --info --glyphs in/turn.mha >info 2>/dev/null
grep -q "21 x 21 x 5, 3 components: vectors" info && grep -q "magnitude: 1 .. 14.1421" info
isorender_refuses 2 "is for surfaces" --glyphs surface
isorender --scene sphere:40 --no-image --points in/points.ply --quiet
isorender_refuses 2 "needs a volume" in/points.ply --glyphs surface
isorender_refuses 6 "2 components" --glyphs in/two.mha
isorender_refuses 6 "every vector is 0" --glyphs in/zero.mha
isorender_refuses 6 "every vector is 0" --lines in/zero.mha
isorender_refuses 6 "no vector is finite" --glyphs in/nan.mha
isorender_refuses 6 "positive definite" --glyphs in/flat.mha
isorender_refuses 6 "holds tensors" --lines in/tensors.mha
isorender_refuses 6 "no streamline" --lines in/turn.mha --least 1000
isorender_refuses 6 "no vector is at least 1000" --glyphs in/turn.mha --least 1000
isorender_refuses 5 "max-memory" --glyphs in/turn.mha --max-memory 20k
isorender_refuses 2 "no array\|not looked for\|has no column" --glyphs in/turn.mha --color-by speed
isorender_refuses 2 "is for --lines" --glyphs in/turn.mha --streamlines 5
isorender_refuses 2 "is not an order" --glyphs in/turn.mha --tensor-order xx,yy
isorender_refuses 2 "above 0" --glyphs in/turn.mha --glyph-scale 0
printf '1 1 0 0 0 1 -1\n2 1 5 0 0 1 1\n' >in/line.swc
isorender_refuses 2 "volumes of vectors" --lines in/line.swc --space fsl
rm -f said
