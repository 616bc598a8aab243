for method in raycast mesh; do
    isorender scene:torus:48 $method.png --aov $method.exr --method $method --resolution 160x160 --quiet 2>log ||
        { grep -q 'without OpenEXR' log && { echo "skipped: built without OpenEXR"; exit 77; }; cat log; exit 1; }
done
isocompare images raycast.exr mesh.exr --json >exr.json
isocompare images raycast.png mesh.png --aov-a raycast.exr --aov-b mesh.exr --json >both.json
python3 - <<'P'
from check import *
exr, both = report("exr.json"), report("both.json")
m, b = exr["metrics"], both["metrics"]
expect(exr["truth"]["silhouette"] == "coverage" and m["psnr"] is None and b["psnr"] > 20, m, b)
expect(0 < m["normal_error_deg"] < 5 and 0 < m["depth_error_voxel"] < 0.2 and m["wrong"] < 2, m)
for key in ("normal_error_deg", "depth_error_voxel", "wrong", "iou", "holes"):
    expect(m[key] == b[key], key, m, b)
P
