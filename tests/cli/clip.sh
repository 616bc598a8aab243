# what --clip leaves of a surface is what raycast shows of it, at three zooms and through layers, with the same bytes for all
# threads and kernels; the picture is drawn again from its scene; cuts that make no sense are refused
options="scene:head:64 --resolution 160x150 --samples 1 --quiet"
draw() { isorender $options "$@" "$name.png" && isorender $options "$@" --method raycast "$name-truth.png"; }
for zoom in 1 3 16; do
    name=plane$zoom draw --zoom $zoom --clip 31,25,30:-.3,-.5,.7
    name=box$zoom draw --zoom $zoom --clip box:15,5,20,35,30,45
    name=balls$zoom draw --zoom $zoom --clip keep:sphere:30,25,30,24 --clip sphere:30,10,30,9
    [ $zoom = 16 ] || name=all$zoom draw --zoom $zoom --clip sphere:30,15,30,15 --clip 'x>35' --clip box:10,5,15,40,40,25
    name=layers$zoom draw --zoom $zoom --clip sphere:30,15,30,15 --clip 'x>35' --opacity .3
done
name=depth draw --clip camera:9 --azimuth 30
name=near draw --clip camera:9 --camera-position 30,20,30 --camera-focal-point 40,60,35
name=two draw --isovalue -2,1 --clip 'x>30@2'
name=one draw --isovalue 1 --clip 'x>30'
cmp -s two.png one.png && exit 1
for cpu in generic avx2 avx512; do
    ISO_CPU=$cpu isorender $options --clip 'x>35' --clip sphere:30,15,30,15 $cpu.png --threads ${#cpu}
    cmp generic.png $cpu.png
done
ball="in/ball.mha --isovalue 500 --resolution 160x150 --samples 1 --quiet --fit box --clip sphere:12,4,12,6 --clip x>16"
python3 -c 'from check import *; ball("in/ball.mha")'
isorender $ball ball.png
for k in 1 2 3; do isorender $ball --chunk-size 16 --part $k/3 -o $k.isokeys; done
isorender merge ?.isokeys -o merged.png --quiet
isorender $ball --method mesh mesh.png
isorender in/ball.mha --isovalue 500 --mesh in/ball.stl --no-image --quiet
echo '0 0 0' >in/points.xyz
isorender --surface in/ball.stl --surface-color E5DCC8 --resolution 160x150 --samples 1 --quiet --fit box \
    --clip sphere:12,4,12,6 --clip 'x>16' object.png
isorender --again plane3.png again.png --quiet
cmp plane3.png again.png
python3 - <<'P'
import glob
from check import *
count = 0
for truth in glob.glob("*-truth.png"):
    a, b = Png(truth.replace("-truth", "")).pixels(), Png(truth).pixels()
    off = sum(max(abs(x - y) for x, y in zip(p, q)) > 2 for p, q in zip(a, b))
    expect(off <= 2, truth, "differs in", off, "pixels")
    expect(len(set(b)) > 50, truth, "shows nothing")
    count += 1
expect(count == 18, count)
whole = Png("ball.png")
expect(whole.rows == Png("merged.png").rows, "parts give another picture")
shown = lambda image: [p[:3] != (255, 255, 255) for p in image.pixels()]
for name in ("mesh", "object"):
    off = sum(a != b for a, b in zip(shown(whole), shown(Png(name + ".png"))))
    expect(off < 60, name, "covers", off, "other pixels")
P
# lines, opaque and translucent: what a plane leaves, and what it takes away, is in both the whole
cat >walk.obj <<'END'
v 0 0 0
v 10 3 0
v 20 0 8
v 30 4 2
l 1 2 3 4
END
for way in one:0.5 two:1; do
    how="--lines walk.obj --radius 2 --line-opacity ${way#*:} --camera-position 15,-90,20 --camera-focal-point 15,0,3 --quiet"
    isorender $how -o ${way%:*}_whole.png
    isorender $how -o ${way%:*}_left.png --clip 'x<16'
    isorender $how -o ${way%:*}_right.png --clip 'keep:x<16' --threads 1
done
python3 - <<'P'
from check import Png, expect
for way in ("one", "two"):
    whole, left, right = (Png(way + end).pixels() for end in ("_whole.png", "_left.png", "_right.png"))
    other = [sum(p != q for p, q in zip(whole, part)) for part in (left, right)]
    both = sum(p != q and p != r for p, q, r in zip(whole, left, right))
    expect(min(other) > 500, way, "is not cut:", other)
    expect(both < 0.1 * min(other), way, "looks different in both halves in", both, "pixels of", other)
P
# points: what is left and what is taken away are together the whole, pixel by pixel, also where discs cross the plane
python3 - <<'P'
import math, random
random.seed(4)
with open("in/cloud.xyz", "w") as f:
    for _ in range(3000):
        v = [random.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        print(*(10 * x / length for x in v), file=f)
P
for way in flat ewa mean large groups; do
    how="--method discs"
    [ $way = large ] && how="--method discs --radius 4"
    [[ $way =~ ewa|mean|groups ]] && how="--method splats --reconstruction $way"
    how="in/cloud.xyz --quiet --camera-position 15,-90,20 --camera-focal-point 0,0,0 --resolution 160x150 $how"
    isorender $how cloud_${way}_whole.png
    isorender $how cloud_${way}_left.png --clip 1,0,0:1,.3,.2
    isorender $how cloud_${way}_right.png --clip keep:1,0,0:1,.3,.2 --threads 1
    isorender $how cloud_${way}_ball.png --clip sphere:0,-10,0,5
    for cpu in generic avx2 avx512; do
        ISO_CPU=$cpu isorender $how $cpu.png --clip sphere:0,-10,0,5 --threads ${#cpu}
        cmp cloud_${way}_ball.png $cpu.png
    done
done
python3 - <<'P'
from check import Png, expect
for way in ("flat", "ewa", "mean", "large", "groups"):
    whole, left, right, ball = (Png("cloud_%s_%s.png" % (way, end)).pixels() for end in ("whole", "left", "right", "ball"))
    other = [sum(p != q for p, q in zip(whole, part)) for part in (left, right, ball)]
    both = sum(p not in (q, r) for p, q, r in zip(whole, left, right))
    expect(min(other) > 100, way, "is not cut:", other)
    expect(both < 0.04 * min(other), way, "looks different in both halves in", both, "pixels of", other)
P
refuses 2 "cuts no pull-push" isorender in/cloud.xyz bad.png --method pullpush --clip 'x<3'
refuses 2 "cuts no translucent discs" isorender in/cloud.xyz bad.png --opacity .5 --clip 'x<3'
refuses 2 "splats cannot draw cuts (--clip) of what is translucent: that needs exact or raycast" isorender scene:head:32 bad.png --method splats --opacity .5 --clip 'x<3'
refuses 6 "leaves nothing" isorender in/cloud.xyz bad.png --clip 'x<30'
for where in 'x<3mm' 'x<' 'w<3' '1,2:0,0,1' '1,2,3:0,0,x' camera:near box:1,2,3,4,5 sphere:1,2,3 keep: @1 'x<3@' 'x<3@0' 'x<nan'; do
    refuses 2 "is not" isorender scene:head:32 bad.png --clip "$where"
done
refuses 2 "it has no direction" isorender scene:head:32 bad.png --clip 1,2,3:0,0,0
refuses 2 "least y, 5, is not below its greatest, 2" isorender scene:head:32 bad.png --clip box:1,5,3,4,2,6
refuses 2 "is not above 0" isorender scene:head:32 bad.png --clip sphere:1,5,3,0
refuses 2 "there is no @2" isorender scene:head:32 bad.png --clip 'x<3@2'
refuses 2 "there is no @3" isorender scene:head:32 bad.png --quiet --glyphs in/points.xyz --clip 'x<3@3'
refuses 2 "needs the cpu" isorender scene:head:32 bad.png --clip 'x<3' --backend egl --method mesh
refuses 2 "points cannot draw cuts (--clip): that needs exact, discs, splats, mesh or raycast" isorender scene:head:32 bad.png --clip 'x<3' --method points
refuses 2 "more than 16 cuts" isorender scene:head:32 bad.png $(for i in $(seq 17); do echo "--clip x<$i"; done)
refuses 6 "along 1,0,0 the plane is at 900 mm, and the surface reaches from" isorender scene:head:32 bad.png --clip 'x<900'
refuses 6 "leaves nothing: along 0,1,0" isorender scene:head:32 bad.png --clip camera:900
refuses 6 "nothing of what --clip leaves is in view" isorender scene:head:32 bad.png --clip keep:sphere:900,0,0,5
