# Occlusion knows what --clip cuts away: a box with a hollow, cut open, is lit like a box of which that half is missing in the
# voxels; a cap that shows the volume is not darkened.
python3 - <<'P'
from check import *
def box(x, y, z):
    return all(8 <= c < 40 for c in (x, y, z)) and not all(16 <= c < 32 for c in (x, y, z))
volume("whole.mha", (48, 48, 48), lambda x, y, z: 200 * box(x, y, z), "MET_UCHAR", "B")
volume("half.mha", (48, 48, 48), lambda x, y, z: 200 * (box(x, y, z) and y >= 24), "MET_UCHAR", "B")
P
camera="--camera-position 24,-70,34 --camera-focal-point 24,24,24 --isovalue 100 --resolution 160x160 --samples 1 --quiet"
for light in "" --occlusion=12 "--occlusion=12 --shadow"; do
    name=x$(echo $light | tr -dc a-z)
    isorender whole.mha cut$name.png $camera --clip 'y<23.5' --cap surface $light
    isorender half.mha half$name.png $camera $light
    isorender whole.mha slice$name.png $camera --clip 'y<23.5' --cap slice --window 100,200 $light
done
python3 - <<'P'
from check import *
def reds(name):
    return [pixel[0] for pixel in Png(name + ".png").pixels()]
for light in ("x", "xocclusion", "xocclusionshadow"):
    cut, half = reds("cut" + light), reds("half" + light)
    inside = [(a, b) for a, b in zip(cut, half) if a != 255 or b != 255]
    mean = sum(abs(a - b) for a, b in inside) / len(inside)
    plain = mean if light == "x" else plain # the voxels round the edges of the half, which a plane cuts sharply
    expect(plain < 10 and abs(mean - plain) < 1, light, mean, plain)
middle = 160 * 80 + 80 # the hollow's far wall: darker than without occlusion, and not black
unlit, lit = reds("cutx")[middle], reds("cutxocclusion")[middle]
expect(40 < lit < unlit - 20, lit, unlit)
cut, white, dark = reds("cutx"), reds("slicex"), reds("slicexocclusion")
caps = [k for k, value in enumerate(white) if value == 255 and cut[k] != 255]
expect(len(caps) > 1000 and all(dark[k] == 255 for k in caps), len(caps))
P
