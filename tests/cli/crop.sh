python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500 --crop 0,23,12,23,0,9 --no-image --json --quiet >j.json
isorender scene:torus:64 --crop 32,63,0,63,0,63 --no-image --json --quiet >t.json
python3 - <<'P'
from check import *
b = report("j.json")["bounds_local"]
expect(11.99 < b[2] < 12.5 and b[5] <= 9.01 and b[0] < 8 and b[4] < 4.5, b)
t = report("t.json")["bounds_local"]
expect(31 <= t[0] <= 34 and t[2] < 16, t)
P
