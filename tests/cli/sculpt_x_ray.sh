# The reference in the pictures of a replay changes nothing else, and is for pictures only.
bear="--replay $volumes/bear.strokes --headless --voxel-size 1"
isosculpt $bear --output plain.ply --draw --resolution 320x200 --json=plain.json
for seen in under over; do
    isosculpt $bear --output $seen.ply --draw --resolution 320x200 --x-ray $seen --json=$seen.json
    cmp plain.ply $seen.ply
done
python3 - <<'P'
from check import *
plain, under, over = report("plain.json"), report("under.json"), report("over.json")
for seen in under, over:
    expect(seen["seconds"]["draw"]["count"] == plain["seconds"]["draw"]["count"] == plain["samples"], seen)
    expect(seen["peak_bytes"] > plain["peak_bytes"], seen, plain)
P
status=0
isosculpt $bear --output b.ply --x-ray over 2>error.txt || status=$?
[ $status -eq 2 ]
grep -q -- '--x-ray is for pictures' error.txt
status=0
isosculpt $bear --output b.ply --draw --x-ray beside 2>error.txt || status=$?
[ $status -eq 2 ]
grep -q "beside" error.txt
