for method in raycast mesh; do
    isorender scene:torus:48 $method.png --method $method --resolution 200x160 --camera iso --quiet
done
isocompare images raycast.png mesh.png >table
grep -q '^psnr_in  *[0-9.]* dB' table
grep -q '^normal_error_deg  *- ' table
grep -q 'silhouette: all that is not FFFFFF' table
isocompare images raycast.png mesh.png --json --pixels-per-voxel 4 >mesh.json
isocompare images raycast.png raycast.png --json=same.json --quiet --difference difference.png
isocompare images raycast.png raycast.png --fail-under psnr=1000 >same
grep -q '^psnr_in  *identical  *PSNR, both' same
isocompare images mesh.png raycast.png --threads 3 --json --background 808080 >wrong_background.json
python3 - <<'P'
from check import *
j = report("mesh.json")
expect(j["schema"] == "isocompare-images/1" and (j["width"], j["height"]) == (200, 160) and j["passed"], j)
m = j["metrics"]
expect(set(m) == {"psnr_in", "psnr", "error_p99", "error_max", "ssim", "flip", "iou", "dilation_mean", "dilation_p99", "dilation_max", "dilation_mean_voxel",
                  "dilation_max_voxel", "holes", "normal_error_deg", "depth_error_voxel", "wrong", "pixels_differing"}, m)
expect(0 < m["error_p99"] < m["error_max"] <= 255 and 0 <= m["dilation_p99"] <= m["dilation_max"], m)
expect(20 < m["psnr_in"] < m["psnr"] < 60 and 0.9 < m["ssim"] < 1 and 0 < m["flip"] < 0.1, m)
expect(0.95 < m["iou"] < 1 and m["dilation_mean_voxel"] == m["dilation_mean"] / 4 and m["wrong"] is None, m)
same = report("same.json")["metrics"]
expect(same["ssim"] == 1 and same["flip"] == 0 and same["iou"] == 1 and same["psnr"] == same["psnr_in"] == "inf", same)
expect(set(Png("difference.png").pixels()) == {(0, 0, 0, 255)}, "difference")
truth = report("wrong_background.json")["truth"]  # white counts as covered then
expect(truth["covered"] == 200 * 160 and truth["silhouette"] == "background", truth)
P
