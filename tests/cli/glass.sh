# glass is seen where the surface is, by every mode and both methods, and is not the surface
options="scene:torus:32 --resolution 60x50 --quiet"
isorender $options opaque.png --samples 1 --json=opaque.json
for mode in none single layers two-sided traced; do
    for method in exact raycast; do
        isorender $options $mode-$method.png --ior 1.5 --refraction $mode --method $method --attenuation-color teal \
            --attenuation-distance 5 --json=$mode-$method.json
    done
done
isorender $options default.png --ior 1.5 --attenuation-color teal --attenuation-distance 5 --json=default.json
isorender $options white.png --ior 1.5 --background white
isorender $options clear.png --ior 1.5 --background none --samples 4
isorender $options two.png --ior 1.5 --samples 4 --threads 2
isorender $options five.png --ior 1.5 --samples 4 --threads 5
cmp two.png five.png
python3 - <<'P'
from check import *
opaque, seen = report("opaque.json"), {}
for mode in ("none", "single", "layers", "two-sided", "traced"):
    a, b = Png(mode + "-exact.png"), Png(mode + "-raycast.png")
    off = sum(max(abs(x - y) for x, y in zip(p, q)) > 2 for p, q in zip(a.pixels(), b.pixels()))
    expect(off <= 3, mode, "differs between exact and raycast in", off, "pixels")
    j = report(mode + "-exact.json")
    expect(abs(j["image"]["covered"] - opaque["image"]["covered"]) <= 2, j["image"]["covered"], opaque["image"]["covered"])
    expect(j["glass"] == {"ior": 1.5, "refraction": mode, "environment": "studio"}, j["glass"])
    seen[mode] = a.pixels()
expect(len({str(pixels) for pixels in seen.values()}) == 5, "two modes give the same picture")
hashes = {report(name + ".json")["image"]["hash"] for name in ("traced-exact", "traced-raycast", "default")}
expect(len(hashes) == 1, "traced is not the default, or differs between the methods")
white, clear = Png("white.png"), Png("clear.png")
expect(white.rows[0][0] == (255, 255, 255, 255) and white.rows[25][15] != (255, 255, 255, 255), white.rows[25][15])
expect(Png("default.png").rows[0][0] != (255, 255, 255, 255), "the environment is not behind the glass")
expect(clear.rows[0][0][3] == 0 and clear.rows[25][15][3] == 255, clear.rows[0][0], clear.rows[25][15])
P
