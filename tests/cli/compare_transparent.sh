isorender scene:cube:32 a.png --resolution 80x80 --background none --method raycast --quiet
isorender scene:cube:32 b.png --resolution 80x80 --background none --method mesh --quiet
isocompare images a.png b.png --json >j.json
python3 - <<'P'
from check import *
j = report("j.json")
expect(j["truth"]["silhouette"] == j["candidate"]["silhouette"] == "alpha", j)
expect(j["truth"]["covered"] < 80 * 80 and j["metrics"]["iou"] > 0.95, j)
P
