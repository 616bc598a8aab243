# planes through the middle by a word, in RAS too; slices are framed; words for sides of a patient; what is said of them
python3 - <<'P'
import struct
from check import *
value = lambda x, y, z: max(0.0, 1000 - 500 * ((x - 9) ** 2 + (y - 11) ** 2 + (z - 7) ** 2) ** 0.5 / 5)
head = "Offset = -12 -10 3\nElementSpacing = 1 2 1.5\n"
volume("in/v.mha", (24, 24, 20), value, header=head)
voxels = b"".join(struct.pack("<f", value(x, y, z)) for z in range(20) for y in range(24) for x in range(24))
h = bytearray(nifti_header((24, 24, 20), 16, 32)[:344] + b"n+1\0" + bytes(4))
struct.pack_into("<f", h, 108, 352)
struct.pack_into("<2h", h, 252, 0, 1)  # by an sform, in RAS
struct.pack_into("<12f", h, 280, -1, 0, 0, 12, 0, -2, 0, 10, 0, 0, 1.5, 3)
open("in/v.nii", "wb").write(bytes(h) + voxels)
P
draw() { isorender "in/$1" "$2" --isovalue 500 --resolution 80 --orthographic "${@:3}"; }
alike() { python3 -c 'import sys; from check import *; sys.exit(Png(sys.argv[1]).rows != Png(sys.argv[2]).rows)' "$1.png" "$2.png"; }
same() { alike $1 $2 || { echo "$1 and $2 differ"; exit 1; }; }
differ() { alike $1 $2 && { echo "$1 and $2 are the same"; exit 1; } || true; }
# the middle of the volume: voxels 11.5, 11.5, 9.5
draw v.mha x.png --clip x --camera iso && draw v.mha x_mm.png --clip 'x<-.5' --camera iso
draw v.mha y.png --clip keep:coronal --camera iso && draw v.mha y_mm.png --clip 'keep:y<13' --camera iso
draw v.mha z.png --slice axial --opacity 0 --camera top && draw v.mha z_mm.png --slice z=17.25 --opacity 0 --camera top
for i in x y z; do same $i ${i}_mm; done
differ x y
# a NIfTI file's x and y have the other signs; what is meant is said, unless it is stated
draw v.nii ras.png --clip ras:'x>3' --slice ras:y=5 --camera iso 2>quiet
draw v.nii lps.png --clip lps:'x<-3' --slice lps:y=-5 --camera iso 2>>quiet
draw v.nii middle.png --clip x --slice axial --clip 'z<0' --clip camera:1 2>>quiet
draw v.nii plain.png --clip 'x<-3' --slice y=-5 --camera iso 2>said
draw v.mha mha.png --clip 'x<-3' --slice y=-5 --camera iso 2>>quiet
same ras lps && same lps plain && same plain mha
! grep "note:.*LPS" quiet
[ "$(grep -c "note: --clip takes LPS.*(--clip ras:.. takes" said)" = 1 ]
for pair in box:-1,-20,-1,30,40,10=box:-30,-40,-1,1,20,10 sphere:-2,12,13,5=sphere:2,-12,13,5 -3,12,13:1,2,3=3,-12,13:-1,-2,3; do
    box=${pair%=*} turned=${pair#*=}
    draw v.mha a.png --clip "$box" --camera iso && draw v.mha b.png --clip "keep:ras:$turned" --camera iso
    draw v.mha c.png --clip "keep:$box" --camera iso
    same b c && differ a b
done
# a slice is in the picture as a whole: an edge of it is never beside it
draw v.mha edge.png --slice z=17.25 --camera top --margin 0.1 --background red
python3 - <<'P'
from check import *
rows = Png("edge.png").rows
shown = [[p[:3] != (255, 0, 0) for p in row] for row in rows]
expect(not any(shown[0]) and not any(shown[-1]) and not any(row[0] or row[-1] for row in shown), "beside the picture")
expect(72 - 10 < sum(any(row) for row in shown) < 68 and sum(row[40] for row in shown) > 60, "not framed")
P
for pair in anterior=front posterior=back superior=top inferior=bottom; do
    draw v.nii a.png --camera ${pair%=*} 2>>quiet && draw v.nii b.png --camera ${pair#*=} 2>>quiet
    same a b
done
! grep "note:.*patient" quiet
isorender scene:torus:16 t.png --camera anterior --resolution 20x20 2>said
grep -q "note: the file does not say where a patient's front" said
isorender_refuses 2 "'w' is not x<MM or x>MM (so y, z), x (below the middle" in/v.mha --clip w
isorender_refuses 2 "'oblique' is not a plane: x=MM, x (in the middle; also sagittal, coronal, axial)" in/v.mha --slice oblique
