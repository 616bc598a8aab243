#!/usr/bin/env bash
# deferred_smoke.sh PROGRAMS FOLDER: the passes of deferred splatting select as the paper says: pass 3 fills the holes that a
# large turn leaves, the frame after it has none, and the other passes lose nothing of the picture.
set -euo pipefail
programs=$1 folder=$2/deferred
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
"$programs/isorender" scene:head:96 --no-image --points head.ply --quiet
"$programs/deferred_splatting" figure head.ply .
"$programs/deferred_splatting" times head.ply >times.json
for pair in a:a b:b c:b d:b; do
    "$programs/isocompare" images "deferred-all-${pair#*:}.png" "deferred-${pair%:*}.png" --json="${pair%:*}.json" >/dev/null
done
python3 - <<'P'
import json
psnr = {letter: float(json.load(open(letter + ".json"))["metrics"]["psnr_in"]) for letter in "abcd"}
assert min(psnr["a"], psnr["c"], psnr["d"]) > 27 and psnr["b"] < 20, psnr
times = json.load(open("times.json"))
assert 0.5 < times["culled"] < 0.95 and times["seconds_with"] > 0 and times["seconds_without"] > 0, times
assert all(times["pass_%d_points_per_second" % number] > 0 for number in (1, 2, 3, 4)), times
P
