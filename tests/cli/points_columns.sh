# --columns says what the numbers of a file of points are; .csv files are then points, too.
printf '0 0 0 7 200 10 10\n9 0 0 8 200 10 10\n0 0 9 9 200 10 10\n9 0 9 9 10 10 200\n0 4 0 9 10 10 200\n' >in/a.xyz
sed 's/ /;/g; 1ifirst;second;third;d;e;f;g' in/a.xyz >in/a.csv
python3 - <<'P'
import struct
rows = [[float(v) for v in line.split()] for line in open("in/a.xyz")]
head = "{'descr': '<f4', 'fortran_order': False, 'shape': (5, 7), }".ljust(117) + "\n"
open("in/a.npy", "wb").write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode()
                             + b"".join(struct.pack("<7f", *row) for row in rows))
P
for kind in xyz csv npy; do
    isorender in/a.$kind $kind.png --columns y,x,z,heat,r,g,b --json=$kind.json --quiet --resolution 100x100
    isorender --info in/a.$kind --columns y,x,z,heat,r,g,b >info
    grep -q 'columns *heat: 7 .. 9' info && grep -q 'colours *of the file' info || { cat info; exit 1; }
    grep -q 'spacing  *9 between nearest neighbours' info
done
python3 - <<'P'
from check import *
a, b, c = (report(k + ".json") for k in ("xyz", "csv", "npy"))
expect(a["bounds_world"] == b["bounds_world"] == c["bounds_world"] and a["bounds_world"] == [0, 4, 0, 9, 0, 9], a["bounds_world"])
expect(a["image"]["hash"] == b["image"]["hash"] == c["image"]["hash"])
P
isorender in/a.xyz skipped.png --columns x,y,z,-,-,-,- --json=skipped.json --quiet --color-by heat 2>said && exit 1
grep -q "has no column 'heat'" said
isorender_refuses 3 "row 1: not as many numbers as there are names" in/a.xyz --columns x,y,z
isorender_refuses 3 "in/a.npy: its rows have 7 numbers, for which there are 3 names" in/a.npy --columns x,y,z
isorender_refuses 2 "'x,y,heat' are not names of columns, with x y z among them" in/a.xyz --columns x,y,heat
isorender_refuses 2 "'x,,y,z' are not names" in/a.xyz --columns x,,y,z
isorender_refuses 2 "--columns is for points in rows of numbers" scene:sphere:16 --columns x,y,z
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' >in/p.ply
isorender_refuses 2 "in/p.ply: --columns is for points in rows of numbers" in/p.ply --columns x,y,z
