# stderr: isorender: in/ball.mha: isovalue * (Otsu*1979*); next candidates: * and *
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --no-image --json >j.json
python3 - <<'P'
from check import *
j = report("j.json")
low, high = j["value_range"]
expect(low < j["isovalue"] < high, j["isovalue"])
P
