isorender scene:torus:32 t.png --turntable 4 --camera right --up +z --resolution 80x60 --json=j.json 2>log
grep -q "wrote t_000.png to t_003.png$" log
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
# one framing for all: as far away as the frame that needs most
python3 -c 'from check import *; ball("in/long.mha", header="ElementSpacing = 1 4 1\n")'
isorender in/long.mha l.png --isovalue 500 --turntable 4 --resolution 40x40 --json=all.json --quiet
for turn in 0 90; do
    isorender in/long.mha $turn.png --isovalue 500 --azimuth $turn --resolution 40x40 --json=$turn.json --quiet
done
python3 - <<'P'
from check import *
def distance(name):
    c = report(name + ".json")["camera"]
    return sum((a - b) ** 2 for a, b in zip(c["position"], c["focal_point"])) ** 0.5
expect(abs(distance("0") - distance("90")) > 1, "the test volume is not long")
expect(abs(distance("all") - max(distance("0"), distance("90"))) < 1e-9, distance("all"), distance("0"), distance("90"))
P
