isorender scene:torus:32 t.png --turntable 4 --camera right --up +z --resolution 80x60 --json=j.json 2>log
grep -q "ffmpeg -framerate 25 -i 't_%03d.png'" log
[ "$(ls t_*.png | tr '\n' ' ')" = "t_000.png t_001.png t_002.png t_003.png " ]
isorender scene:torus:32 'x{n:2}.png' --turntable 2 --resolution 40x30 --quiet
[ -f x00.png ] && [ -f x01.png ]
python3 - <<'P'
from check import *
j = report("j.json")
expect([f["path"] for f in j["frames"]] == ["t_00%d.png" % i for i in range(4)], j["frames"])
# a quarter turn of the torus about its axis changes nothing but rounding: one framing for all
covered = [f["covered"] for f in j["frames"]]
expect(max(covered) - min(covered) < 0.05 * max(covered), covered)
P
