if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
# a ball of radius 8 voxels of 0.5 mm around 15.75 25.75 35.75, seen from the front (along +y)
python3 -c 'from check import *; ball("in/ball.mha", header="ElementSpacing = 0.5 0.5 0.5\nOffset = 10 20 30\n")'
for samples in 1 4; do
    for method in exact points mesh raycast; do
        isorender in/ball.mha $method.png --isovalue 500 --method $method --samples $samples --resolution 90x70 \
            --aov $method$samples.exr --json=$method.json --quiet
    done
done
# the picture is the same without, and the numbers are the same without the picture and for any number of threads
isorender in/ball.mha alone.png --isovalue 500 --method mesh --samples 4 --resolution 90x70 --quiet
cmp alone.png mesh.png
isorender in/ball.mha --isovalue 500 --method mesh --samples 4 --resolution 90x70 --aov alone.exr --no-image --threads 5 --quiet
cmp alone.exr mesh4.exr
python3 - <<'P'
from check import *
for name in ("exact1", "exact4", "points1", "points4", "mesh1", "mesh4", "raycast1", "raycast4"):
    e, j = Exr(name + ".exr"), report(name[:-1] + ".json")
    expect((e.width, e.height, e.names) == (90, 70, ["A", "N.X", "N.Y", "N.Z", "Z"]), name, e.names)
    expect(struct.unpack("<f", e.attributes["isopointVoxel"]) == (0.5,), e.attributes)
    expect(b"--method=" + name[:-1].encode() in e.attributes["comments"], e.attributes["comments"])
    samples = int(name[-1])
    expect(name[-1] == "1" or round(sum(e.planes["A"]) * samples) == j["image"]["covered"], name, "covered")
    expect(any(0 < a < 1 for a in e.planes["A"]) == (samples > 1), name, "partial coverage")
    eye = j["camera"]["position"]
    seen = 0
    for a, x, y, z, depth in zip(*(e.planes[c] for c in ("A", "N.X", "N.Y", "N.Z", "Z"))):
        length = (x * x + y * y + z * z) ** 0.5
        if a == 0:
            expect(depth == float("inf") and length == 0, name, "empty", depth, length)
            continue
        seen += 1
        expect(abs(length - 1) < 1e-5, name, "length", length)
        if a == 1:  # the depth of the ball where its normal is this one; the ball faces the eye
            expect(abs(25.75 + 4 * y - eye[1] - depth) < (0.3 if name[0] == "p" else 0.12), name, depth, y, eye)
    expect(seen > 1500, name, seen)
P
isorender scene:torus:32 --aov 'r{n:2}.exr' --no-image --turntable 3 --resolution 40x30 --quiet
isorender scene:torus:32 t.png --aov t.exr --turntable 2 --resolution 40x30 --json=t.json --quiet
[ "$(ls r0*.exr t_* | tr '\n' ' ')" = "r00.exr r01.exr r02.exr t_000.exr t_000.png t_001.exr t_001.png " ]
python3 -c 'from check import *; f = report("t.json")["frames"]; expect([x["aov_path"] for x in f] == ["t_000.exr", "t_001.exr"], f)'
! cmp -s t_000.exr t_001.exr
