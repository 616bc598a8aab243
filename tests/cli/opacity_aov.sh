if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
# depth and normal of the first layer are those of the opaque surface; alpha and the number of layers are the layers'
isorender scene:torus:32 opaque.png --samples 1 --aov opaque.exr --resolution 60x50 --quiet
isorender scene:torus:32 glass.png --aov glass.exr --opacity 0.25 --opacity-mode constant --resolution 60x50 --quiet
python3 - <<'P'
from check import *
opaque, glass = Exr("opaque.exr"), Exr("glass.exr")
expect(glass.names == ["A", "N.X", "N.Y", "N.Z", "Z", "layers"], glass.names)
for name in ("N.X", "N.Y", "N.Z", "Z"):
    expect(glass.planes[name] == opaque.planes[name], name, "differs")
for a, layers, covered in zip(glass.planes["A"], glass.planes["layers"], opaque.planes["A"]):
    expect((layers > 0) == (covered > 0) and layers in (0, 2, 4), layers, covered)
    expect(abs(a - (1 - 0.75 ** layers)) < 1e-5, a, layers)
expect(max(glass.planes["layers"]) == 4, "no ray meets the torus twice")
P
