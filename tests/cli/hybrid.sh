# points and triangles in one pyramid: no holes where the ray caster sees a surface, at zooms where bricks of both kinds
# are in view; what does not fit is refused
python3 - <<'P'
from check import *
ball("in/ball.mha", side=64, radius=26.0)
P
for zoom in 1 2; do
    for method in hybrid raycast mesh; do
        isorender in/ball.mha ${method}_$zoom.png --isovalue 500 --method $method --zoom $zoom --view-angle 60 \
            --resolution 220x200 --quiet
    done
done
isorender in/ball.mha threads.png --isovalue 500 --method hybrid --zoom 1 --view-angle 60 --resolution 220x200 --quiet --threads 2
cmp hybrid_1.png threads.png
python3 - <<'P'
from check import *
for zoom in (1, 2):
    pixels = {m: Png("%s_%d.png" % (m, zoom)).pixels() for m in ("hybrid", "raycast", "mesh")}
    width, height = 220, 200
    seen = {m: [p[:3] != (255, 255, 255) for p in pixels[m]] for m in pixels}
    inner = [y * width + x for y in range(1, height - 1) for x in range(1, width - 1)
             if all(seen["raycast"][(y + j) * width + x + i] for i in (-1, 0, 1) for j in (-1, 0, 1))]
    holes = [i for i in inner if not seen["hybrid"][i]]
    expect(len(inner) > 5000 and len(holes) * 1000 <= len(inner), zoom, len(inner), holes[:9])
    expect(pixels["hybrid"] != pixels["mesh"], "no points at zoom", zoom)
    off = [max(abs(a - b) for a, b in zip(pixels["hybrid"][i], pixels["raycast"][i])) for i in inner]
    expect(sum(off) / len(off) < 6, zoom, sum(off) / len(off))
P
printf '1 1 3 12 12 1 -1\n2 1 20 12 12 1 1\n' >in/line.swc
isorender_refuses 2 "hybrid" in/ball.mha --isovalue 500 --primitive foot --method hybrid
isorender_refuses 2 "hybrid" in/ball.mha --isovalue 500 --opacity 0.5 --method hybrid
isorender_refuses 2 "hybrid" in/ball.mha --isovalue 500 --ior 1.5 --method hybrid
isorender_refuses 2 "there are lines, glyphs or meshes only" in/line.swc --method hybrid
