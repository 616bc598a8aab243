# red, green and blue are refracted with indices of their own, (ior - 1) / ABBE apart, by every mode and method
look="scene:torus:32 --resolution 60x50 --quiet --attenuation-color teal --attenuation-distance 9"
for mode in single layers two-sided traced; do
    for method in exact splats; do
        [ $mode$method = tracedsplats ] && continue
        isorender $look white.png --ior 1.5 --refraction $mode --method $method --dispersion 5 --json=white.json
        isorender $look red.png --ior 1.45 --refraction $mode --method $method
        isorender $look green.png --ior 1.5 --refraction $mode --method $method
        isorender $look blue.png --ior 1.55 --refraction $mode --method $method
        python3 - <<'P'
from check import *
white = Png("white.png").pixels()
for k, name in enumerate(("red", "green", "blue")):
    expect([p[k] for p in white] == [p[k] for p in Png(name + ".png").pixels()], name)
expect(report("white.json")["glass"]["dispersion"] == 5, report("white.json")["glass"])
P
    done
done
isorender_refuses 2 "dispersion is for glass" scene:torus:32 --dispersion 30
isorender_refuses 2 "is not in 1" scene:torus:32 --ior 1.5 --dispersion 0
