isorender scene:cube:16 --no-image --json=a.json --quiet
[ ! -e cube.png ]
mkfifo in/pipe
timeout 20 cat in/pipe >b.json &
isorender scene:cube:16 --no-image --json=in/pipe --quiet
wait
[ -p in/pipe ]
python3 - <<'P'
from check import *
a, b = report("a.json"), report("b.json")
expect(a["primitives"] == b["primitives"] and a["primitives"]["cells"] > 100 and "image" not in a, a)
P
