# two balls, one in the other: surfaces at 500 (radius 8) and 800 (radius 3.2)
python3 -c 'from check import *; ball("in/ball.mha")'
options="in/ball.mha --isovalue 500,800 --color ivory,navy --resolution 80x60 --quiet"
for method in exact raycast; do
    isorender $options $method.png --opacity 0.4,1 --method $method --json=$method.json
    isorender $options layers_$method.png --opacity 0.4 --opacity-mode constant --method $method --json=layers_$method.json
done
isorender $options opaque.png
isorender $options zero.png --opacity 0,1
isorender in/ball.mha bone.png --samples 1 --isovalue 800 --color navy --resolution 80x60 --quiet \
    --camera-position 11.5,-60,11.5 --camera-focal-point 11.5,11.5,11.5
isorender $options zero.png --opacity 0,1 --camera-position 11.5,-60,11.5 --camera-focal-point 11.5,11.5,11.5
isorender $options first.png --opacity 0.4 --layers 1 --json=first.json
isorender $options xray.png --opacity 0 --absorption 5 --background none
python3 - <<'P'
from check import *
for name in ("exact", "raycast"):
    j, all_layers = report(name + ".json"), report("layers_" + name + ".json")
    expect(j["opacities"][1] == 1 and abs(j["opacities"][0] - 0.4) < 1e-6, j["opacities"])
    expect(j["image"]["layers"]["most"] == 2, name, j["image"]["layers"])
    expect(all_layers["opacities"][1] == all_layers["opacities"][0], all_layers["opacities"])
    expect(all_layers["image"]["layers"]["most"] == 4, name, all_layers["image"]["layers"])
expect(report("first.json")["image"]["layers"]["most"] == 2, report("first.json")["image"]["layers"])
exact, raycast, opaque = Png("exact.png"), Png("raycast.png"), Png("opaque.png")
off = max(abs(x - y) for p, q in zip(exact.pixels(), raycast.pixels()) for x, y in zip(p, q))
expect(off <= 1, "exact and raycast differ by", off)
expect(exact.rows[30][40] != opaque.rows[30][40], "the inner ball is not seen")
zero, bone = Png("zero.png"), Png("bone.png")
expect(list(zero.pixels()) == list(bone.pixels()), "a surface of opacity 0 is seen")
xray = Png("xray.png")
expect(xray.rows[0][0][3] == 0 and 0 < xray.rows[30][24][3] < xray.rows[30][40][3] <= 255, xray.rows[30][24], xray.rows[30][40])
P
[ -z "$(isorender $options --opacity 0.4,1 said.png 2>&1)" ]
isorender in/ball.mha --isovalue 500,800 --opacity 0.4 --resolution 20x20 said.png 2>&1 | grep -q "1 opacities for 2 isovalues: the last one, 0.4, repeats"
