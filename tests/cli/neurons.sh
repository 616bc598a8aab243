# The box of a neuron with a thick soma and thin neurites, and somata of one and of three points, in micrometres.
printf '1 1 0 0 0 10 -1\n2 3 0 10 0 1 1\n3 3 0 40 0 1 2\n' >in/tapered.swc
printf '1 1 0 0 0 5 -1\n2 1 0 0 0 5 1\n3 1 0 0 0 5 1\n4 3 0 0 20 1 1\n' >in/sphere.swc
printf '1 1 0 0 0 5 -1\n2 1 0 5 0 5 1\n3 1 0 -5 0 5 1\n4 3 0 0 20 1 1\n' >in/three.swc
printf '1 1 0 0 0 5 -1\n2 1 0 5 0 5 1\n3 1 0 -9 0 5 1\n4 3 0 0 20 1 1\n' >in/other.swc
printf '1 1 0 0 0 5 -1\n2 1 0 5 0 5 1\n3 1 0 -5 0 5 1\n4 3 0 0 20 1 3\n' >in/branch.swc
sed 's/ 0 / 0,00 /g; s/ 40 / 40,0 /' in/tapered.swc >in/decimal_commas.swc
tr ' ' ',' <in/tapered.swc >in/commas.swc
for name in tapered sphere three other branch decimal_commas commas; do
    isorender --lines in/$name.swc $name.png --resolution 80x80 --json=$name.json 2>$name.said
done
grep -q 'note: .*somata of three points, which are drawn as spheres: 1' three.said
isorender --info --lines in/tapered.swc | grep -q 'bounds .* um$'
python3 - <<'P'
from check import *
box = {n: report(n + ".json")["bounds_world"] for n in ("tapered", "sphere", "three", "other", "branch", "decimal_commas", "commas")}
expect(box["tapered"] == box["decimal_commas"] == box["commas"], "commas", box)
expect(box["tapered"] == [-10, 10, -10, 41, -10, 10], box["tapered"])
expect(box["three"] == box["sphere"] == [-5, 5, -5, 5, -5, 21], box)
expect(report("three.json")["image"]["hash"] == report("sphere.json")["image"]["hash"], "not drawn as a sphere")
expect(box["other"][2:4] == [-14, 10] and box["branch"][2:4] == [-10, 10], box)
P
