python3 -c 'from check import *; ball("in/ball.mha", side=32, radius=9.0)'
# the outer surface is cut open: the inner one is seen in it
isorender in/ball.mha out.png --isovalue 300,700 --color FF0000 --color 0000FF --crop 0,31,16,31,0,31 \
    --resolution 100x100 --json=j.json --quiet --method mesh
python3 - <<'P'
from check import *
pixels = Png("out.png").pixels()
red = sum(1 for p in pixels if p[0] > 60 and p[2] < p[0] / 2)
blue = sum(1 for p in pixels if p[2] > 60 and p[0] < p[2] / 2)
expect(red > 500 and blue > 500, red, blue)
j = report("j.json")
expect(j["isovalues"] == [300, 700] and j["colors"] == ["FF0000", "0000FF"], j["isovalues"], j["colors"])
expect(j["bounds_local"][2] >= 16, j["bounds_local"])
P
