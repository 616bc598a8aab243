# stderr: isorender: in/a.mha: note: 2 voxels are NaN or infinite*wrote out.png
python3 - <<'P'
from check import *
odd = {(3, 3, 3): float("nan"), (9, 9, 9): float("inf")}
volume("in/a.mha", (12, 12, 12), lambda x, y, z: odd.get((x, y, z), float(x)))
P
isorender in/a.mha out.png --isovalue 5.5 --camera iso --json=j.json --resolution 50x50
python3 - <<'P'
from check import *
expect(report("j.json")["nonfinite"] == 2, report("j.json"))
P
