# points with opacities of their own are translucent by every --transparency, without an --opacity
python3 - <<'P'
from math import cos, sin, sqrt
def sphere(path, header, row):
    with open(path, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 2000\n" + "".join("property float %s\n" % n for n in
                   ("x", "y", "z", "nx", "ny", "nz")) + "property uchar red\nproperty uchar green\nproperty uchar blue\n" + header +
                   "end_header\n")
        for i in range(2000):
            z = 1 - (2 * i + 1) / 2000
            n = (sqrt(1 - z * z) * cos(2.4 * i), sqrt(1 - z * z) * sin(2.4 * i), z)
            file.write("%.5f %.5f %.5f %.5f %.5f %.5f 200 120 60%s\n" % (*(10 * a for a in n), *n, row))
sphere("in/alpha.ply", "property uchar alpha\n", " 90")
sphere("in/opaque.ply", "", "")
P
for how in sorted groups nearest; do
    isorender in/alpha.ply $how.png --transparency $how --opacity-mode constant --resolution 120x120 --quiet --json=$how.json
    isorender in/opaque.ply given_$how.png --transparency $how --opacity-mode constant --opacity 0.353 --resolution 120x120 --quiet
    isocompare images given_$how.png $how.png --fail-under psnr=40 >/dev/null
done
isocompare images sorted.png groups.png --fail-under psnr=30 >/dev/null
isorender_refuses 2 "transparency is for translucent surfaces" in/opaque.ply --transparency groups
isorender_refuses 2 "transparency is for translucent surfaces" in/alpha.ply --transparency groups --opacity 1
isorender_refuses 2 "transparency is for translucent surfaces" scene:sphere:16 --transparency nearest
