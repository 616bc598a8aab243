# Caps and slices of volumes that are drawn in chunks and in parts have the bytes of those of the whole: where one plane cuts and where several
# bodies do, where chunks lie inside the solid, beside voxels that are no numbers, for every size of chunk and number of threads
python3 - <<'P'
import math
from check import *
value = lambda x, y, z: 1900 - 1.8 * ((x - 36) ** 2 + 1.4 * (y - 28) ** 2 + 1.5 * (z - 24) ** 2) + 40 * (x % 3) + 30 * ((x * y + z) % 5)
volume("in/v.mha", (75, 60, 50), lambda x, y, z: math.nan if x == y == z else value(x, y, z),
       header="ElementSpacing = 1.5 1 2\nOffset = 5 -7 3\nTransformMatrix = .8 .6 0 -.6 .8 0 0 0 1\n")
with open("in/w_75x60x50_int16.raw", "wb") as file:
    file.write(struct.pack("<225000h", *[int(value(x, y, z)) for z in range(50) for y in range(60) for x in range(75)]))
rows = [bytes(min(255, 3 * min(x, 191 - x), most) for x in range(192)) for most in range(0, 288, 3)] # a box, blocks of which are inside
with open("in/box_192x192x192_uint8.raw", "wb") as file:
    for z in range(192):
        file.write(b"".join(rows[min(y, 191 - y, z, 191 - z)] for y in range(192)))
import itertools, json, os # tiles, of which those in the middle are not in the file: they have the fill value, which is inside
os.mkdir("in/tiles.zarr")
depth = [min(i, 159 - i) for i in range(160)]
for place in itertools.product(range(5), repeat=3):
    if not all(1 <= i <= 3 for i in place):
        z, y, x = ([depth[32 * i + k] for k in range(32)] for i in place)
        with open("in/tiles.zarr/%d.%d.%d" % place, "wb") as file:
            file.write(bytes(min(200, 7 * min(i, j, k)) for k in z for j in y for i in x))
json.dump(dict(zarr_format=2, shape=[160] * 3, chunks=[32] * 3, dtype="|u1", compressor=None, fill_value=200, order="C", filters=None),
          open("in/tiles.zarr/.zarray", "w"))
P
count=0 isovalue=500
same() {
    options="$* --quiet --resolution 150x120 --isovalue $isovalue --fit box --no-index"
    isorender $options -o whole.png
    isorender $(sed -E 's/--window [^ ]+//; s/--slice [^ ]+//g; s/--opacity 0//; s/--color-bar[^ ]*//' <<<"$options") -o plain.png --cap none
    if cmp -s whole.png plain.png; then echo "no cap: $*"; exit 1; fi
    for side in 16 20 48; do
        isorender $options -o chunks.png --chunk-size $side --threads $((side / 8 - 1))
        cmp whole.png chunks.png
    done
    for k in 1 2 3; do isorender $options --chunk-size 16 --part $k/3 -o $k.isokeys; done
    isorender merge 3.isokeys 1.isokeys 2.isokeys -o merged.png --quiet
    isorender $options --chunk-size 16 --part 1/1 -o 1.isokeys
    isorender merge 1.isokeys -o one.png --quiet
    python3 -c 'from check import *
whole = Png("whole.png").rows
expect(whole == Png("merged.png").rows and whole == Png("one.png").rows, sys.argv)' "$@"
    count=$((count + 1))
}
w=in/w_75x60x50_int16.raw
same in/v.mha --clip 50,47,45:-.3,-.7,.4 --cap slice --samples 1
same in/v.mha --clip 50,47,45:-.3,-.7,.4 --cap slice --window 900,800 --orthographic
same in/v.mha --clip 'y<40' --cap red
same in/v.mha --clip camera:25 --cap surface --samples 4 --azimuth 30
same in/v.mha --clip 50,47,45:-.3,-.7,.4 --clip 'x<30' --cap slice:viridis --samples 1
same in/v.mha --clip 'x<20' --clip 'z>45' --cap lime --elevation 40
same $w --clip 'y<32' --cap slice --samples 1 # the border of chunks
same $w --clip 'x>32' --clip 'z>16' --clip 'y<16' --cap slice --azimuth 50 --elevation 40
same $w --clip sphere:55,4,30,22 --clip 'x>60' --cap slice
same $w --clip keep:box:20,1,14,60,48,37 --cap surface --azimuth 40
same $w --clip box:10,-7,4,48,33,32 --clip camera:14 --cap slice --azimuth 35 --elevation 20
isovalue=60
same in/box_192x192x192_uint8.raw --clip 96,96,96:-1,-2,.5 --cap slice
same in/box_192x192x192_uint8.raw --clip 'y<90' --clip 'x<50' --cap slice
same in/tiles.zarr --clip 80,80,80:-1,-2,.5 --cap slice
same in/tiles.zarr --clip 'y<80' --clip 'x<50' --cap red
same in/tiles.zarr --slice 80,80,80:-1,-2,.5 --slice axial
same in/box_192x192x192_uint8.raw --clip 'y<90' --cap slice --slice x=96 --slice 96,96,96:1,2,-.5 # the borders of chunks, and a cap's plane
isovalue=500
same in/v.mha --slice axial --slice coronal --slice sagittal --samples 1
same in/v.mha --slice 50,47,45:-.3,-.7,.4 --window 900,800 --orthographic --azimuth 70
same in/v.mha --clip 'x<30' --clip 'y<20' --cap red --slice 50,47,45:-.3,-.7,.4 --slice z=60
same $w --slice z=16 --slice z=17 --opacity 0 --camera top --orthographic
same $w --slice camera:20 --opacity 0 --azimuth 30
same in/v.mha --clip 'y<40' --cap slice:viridis --color-bar --samples 1
same in/v.mha --slice axial --window 900,800 --color-bar=MR --orthographic --scale-bar --font-size 9
[ $count = 24 ]
# parts whose bars differ are no parts of one picture
for k in 1 2; do
    isorender in/v.mha --slice axial --window 900,${k}00 --color-bar --part $k/2 -o bar$k.isokeys --quiet
done
refuses 3 "bar2.isokeys.*of another picture" isorender merge bar1.isokeys bar2.isokeys -o bad.png
refuses 2 "opacity cannot be drawn in chunks" isorender in/v.mha bad.png --opacity .5 --chunk-size 16
refuses 2 "2 names for 1 bar" isorender in/v.mha --clip 'y<2' --cap slice '--color-bar=a;b' --part 1/2 -o bad.isokeys --quiet
refuses 2 "none of them is given" isorender in/v.mha --color-bar --part 1/2 -o bad.isokeys --quiet
