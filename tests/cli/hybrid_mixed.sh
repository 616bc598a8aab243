# pictures that show points and triangles of one surface: nearer to the exact one than points alone, of closed surfaces and
# of open ones, whose seams have fewer holes than points
compare() {
    local scene=$1 method
    shift
    for method in raycast hybrid pullpush; do
        isorender "$scene" "$method.png" --method "$method" --primitive edge --resolution 256x256 --samples 1 --fit box --quiet "$@"
    done
    for method in hybrid pullpush; do
        isocompare images raycast.png "$method.png" --json --quiet >"$method.json"
    done
    python3 - "$scene" <<'P'
import sys
from check import *
hybrid, points = (report(method + ".json")["metrics"] for method in ("hybrid", "pullpush"))
expect(hybrid["psnr_in"] >= points["psnr_in"] + 1, sys.argv[1], hybrid["psnr_in"], points["psnr_in"])
expect(hybrid["holes"] <= max(0.02, points["holes"] / 2), sys.argv[1], hybrid["holes"], points["holes"])
P
}
compare scene:torus:80 --azimuth 40 --elevation 25 --view-angle 60
compare scene:torus:80 --azimuth 100 --elevation 40 --view-angle 75 --zoom 0.9
compare scene:sphere:64 --azimuth 40 --elevation 25 --view-angle 90
compare scene:gyroid:48 --azimuth 40 --elevation 25 --view-angle 60
compare scene:gyroid:64 --azimuth 10 --elevation 50 --view-angle 60 --zoom 1.2
