# glass of points, of a file and of a volume, is near the glass of the field that the points are of
isorender scene:torus:64 --no-image --points in/torus.ply --quiet
look="--resolution 160x120 --samples 4 --elevation 25 --quiet --ior 1.5"
tint="--attenuation-color teal --attenuation-distance 20"
isorender scene:torus:64 traced.png $look $tint
isorender scene:torus:64 two-sided.png $look $tint --refraction two-sided
isorender in/torus.ply file.png $look $tint --json=file.json
isorender scene:torus:64 volume.png $look $tint --method splats
isocompare images traced.png file.png --fail-under psnr_in=22 >/dev/null
isocompare images two-sided.png file.png --fail-under psnr_in=30 >/dev/null
isocompare images two-sided.png volume.png --fail-under psnr_in=30 >/dev/null
# layers of points are those of the field, counted exactly or by the opacity that they accumulate; a single one is not
for mode in none single layers; do
    isorender scene:torus:64 field_$mode.png $look --opacity 0.2 --refraction $mode
    for how in sorted nearest; do
        isorender in/torus.ply $how.png $look --opacity 0.2 --refraction $mode --transparency $how --threads 1
        isorender in/torus.ply five.png $look --opacity 0.2 --refraction $mode --transparency $how --threads 5
        ISO_CPU=generic isorender in/torus.ply generic.png $look --opacity 0.2 --refraction $mode --transparency $how
        cmp $how.png five.png
        cmp $how.png generic.png
        isocompare images field_$mode.png $how.png --fail-under psnr_in=29 >/dev/null
    done
done
! isocompare images field_layers.png field_single.png --fail-under psnr_in=29 >/dev/null
isorender in/torus.ply usual.png $look --opacity 0.2 --transparency nearest --json=usual.json
isocompare images nearest.png usual.png --fail-under psnr=100 >/dev/null
python3 - <<'P'
from check import *
file, usual = report("file.json"), report("usual.json")
expect(file["glass"] == {"ior": 1.5, "refraction": "two-sided", "environment": "studio"}, file["glass"])
expect(file["method"] == "splats" and "opacities" not in file, file["method"])
expect(usual["glass"] == {"ior": 1.5, "refraction": "layers", "surface_opacity": 0.2, "environment": "studio"}, usual["glass"])
P
isorender_refuses 2 "splats cannot draw --refraction traced: that needs exact or raycast" scene:torus:64 --method splats --ior 1.5 --refraction traced
isorender_refuses 2 "refraction traced needs a volume" in/torus.ply --ior 1.5 --refraction traced
isorender_refuses 2 "sorted or nearest" in/torus.ply --ior 1.5 --transparency groups
isorender_refuses 2 "two-sided needs sorted" in/torus.ply --ior 1.5 --transparency nearest --refraction two-sided
isorender_refuses 2 "attenuation-color needs sorted" in/torus.ply --ior 1.5 --transparency nearest $tint
isorender_refuses 2 "splats (ewa) cannot draw glass (--ior): that needs exact, splats (groups or flat) or raycast" in/torus.ply --ior 1.5 --method splats --reconstruction ewa
isorender_refuses 2 "cannot draw glass" in/torus.ply --ior 1.5 --method points
# colours and opacities of the points are left out, and that is said
printf 'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nend_header\n0 0 0 0 -1 0 1 2 3 90\n1 0 0 0 -1 0 1 2 3 90\n' >in/colored.ply
isorender in/colored.ply colored.png --ior 1.5 --resolution 64x64 2>said
grep -q 'note: its points have colours, but glass' said
grep -q 'note: its points have opacities, but glass' said
