#!/usr/bin/env bash
# quality_smoke.sh BENCH FOLDER: runs bench quality on small pictures of scenes and checks what it writes.
set -euo pipefail
bench=$1 folder=$2
"$bench" quality --side=96 --volumes=sphere,cube --folder=/nowhere --json="$folder/quality.json" \
    >"$folder/quality.txt" 2>"$folder/quality.err"
grep -q 'no real volumes' "$folder/quality.err"
! "$bench" quality --volumes=nothing --folder=/nowhere 2>/dev/null || { echo "an unknown volume was accepted"; exit 1; }
! "$bench" quality --side=50 2>/dev/null || { echo "a side of 50 was accepted"; exit 1; }
python3 - "$folder/quality.json" "$folder/quality.txt" <<'END'
import json, sys

rows = json.load(open(sys.argv[1]))
text = open(sys.argv[2]).read()
wanted = {"volume", "zoom", "method", "psnr_in", "psnr", "holes", "iou", "dilation_mean", "dilation_max", "ssim", "flip",
          "normal_error_deg", "depth_error_voxel", "wrong", "pixels_differing"}
methods = {row["method"] for row in rows}
assert {"points", "mesh", "splats-flat", "splats-onepass", "splats-ewa"} <= methods, methods
assert len(rows) == 2 * 3 * len(methods) and {row["zoom"] for row in rows} == {1, 4, 16}, len(rows)
for row in rows:
    assert wanted <= set(row), wanted - set(row)
    assert all(row[key] is not None for key in wanted), row
    assert 0 < row["iou"] <= 1 and 0 <= row["holes"] <= 100, row
    mesh = [r for r in rows if r["method"] == "mesh" and (r["volume"], r["zoom"]) == (row["volume"], row["zoom"])][0]
    if row["method"] == "points":
        assert row["psnr_in"] < mesh["psnr_in"] and row["flip"] > mesh["flip"], (row, mesh)
assert text.count("\n") > len(rows) and "mean" in text
END
