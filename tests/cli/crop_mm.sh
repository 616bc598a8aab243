# --crop-mm keeps the voxels whose positions lie in the box, whatever spacing, origin and direction are.
python3 - <<'P'
from check import *
ball("in/ball.mha", header="Offset = -10 20 5\nElementSpacing = 0.5 1 2\n")
ball("in/flipped.mha", header="Offset = -10 20 5\nElementSpacing = 0.5 1 2\nTransformMatrix = -1 0 0 0 1 0 0 0 1\n")
ball("in/oblique.mha", header="Offset = 0 0 0\nElementSpacing = 1 1 1\nTransformMatrix = 0.8 0.6 0 -0.6 0.8 0 0 0 1\n")
P
box() {
    isorender "$1" --isovalue 500 --crop-mm "$2" --no-image --json --quiet | python3 -c 'import json, sys; print(json.load(sys.stdin)["volume"]["crop"])'
}
[ "$(box in/ball.mha -7.5,-2,30,100,-50,25)" = "[5, 16, 10, 23, 0, 10]" ]
[ "$(box in/ball.mha -7.6,-2.1,29.1,100,-50,26.9)" = "[5, 15, 10, 23, 0, 10]" ]
[ "$(box in/flipped.mha -17.5,-12,20,100,-50,25)" = "[4, 15, 0, 23, 0, 10]" ]
[ "$(box in/oblique.mha 0,5,5,10,0,9)" = "[3, 10, 1, 8, 0, 9]" ]
isorender in/ball.mha a.png --isovalue 500 --crop 5,16,10,23,0,10 --resolution 64x64 --quiet
isorender in/ball.mha b.png --isovalue 500 --crop-mm=-7.5,-2,30,100,-50,25 --resolution 64x64 --quiet
python3 -c 'from check import *; expect(Png("a.png").pixels() == Png("b.png").pixels())'
# isorender -> 2 and one line for each of: both crops, a box beside the volume, a box that is none
fails() { refuses 2 "$1" isorender in/ball.mha bad.png --isovalue 500 "${@:2}"; }
fails "--crop and --crop-mm cannot be combined" --crop 0,1,0,1,0,1 --crop-mm 0,1,0,1,0,1
fails "in/ball.mha: no voxel lies in --crop-mm 100,110,20,40,5,50: the volume's are in -10,1.5,20,43,5,51 mm" --crop-mm 100,110,20,40,5,50
fails "no voxel lies in --crop-mm 0.1,0.2,20,40,5,50: the volume's are in" --crop-mm 0.1,0.2,20,40,5,50
fails "is not x0,x1,y0,y1,z0,z1 in mm" --crop-mm 5,1,20,40,5,50
