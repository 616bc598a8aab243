# further volumes in the picture: the pixels of several isovalues of one volume; volumes at other places; reports
python3 - <<'P'
from check import *
ball("in/ball.mha")
# turned about z, of other spacing, and moved so that it overlaps the first ball
ball("in/turned.mha", radius=9.0,
     header="TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 16 2 3\nElementSpacing = 0.6 0.5 0.7\n")
ball("in/far.mha", header="Offset = 300 0 0\n")
P
options="in/ball.mha --resolution 90x70 --quiet"
for method in exact raycast mesh discs pullpush; do
    isorender $options several_$method.png --isovalue 500,800 --color ivory,navy --method $method --azimuth 20
    isorender $options further_$method.png --isovalue 500 --color ivory --volume in/ball.mha --volume-isovalue 800 \
        --volume-color navy --method $method --azimuth 20
done
isorender $options several_glass.png --isovalue 500,800 --color ivory,navy --opacity 0.3,0.6
isorender $options further_glass.png --isovalue 500 --color ivory --opacity 0.3 --volume in/ball.mha --volume-isovalue 800 \
    --volume-color navy --volume-opacity 0.6
for method in exact raycast; do
    isorender $options both_$method.png --isovalue 500 --opacity 0.3 --volume in/turned.mha --volume-isovalue 400 \
        --volume-opacity 0.5 --volume in/turned.mha --azimuth 30 --fit tight --method $method --json=$method.json
done
isorender --volume in/ball.mha --volume in/turned.mha --volume-isovalue 500 pair.png --quiet --json=pair.json
isorender in/ball.mha alone.png --isovalue 500 --volume in/turned.mha --volume-isovalue 500 --quiet
printf '1 1 3 12 12 1 -1\n2 1 20 12 12 1 1\n' >in/line.swc
isorender in/line.swc line.png --volume in/ball.mha --volume-isovalue 500 --volume-opacity 0.3 --quiet --json=line.json
isorender in/ball.mha mesh.png --isovalue 500 --volume in/turned.mha --mesh both.stl --quiet --json=mesh.json
isorender in/ball.mha --isovalue 500 --no-image --volume in/turned.mha --mesh only.stl --quiet
cmp both.stl only.stl
python3 - <<'P'
from check import *
for name in ("exact", "raycast", "mesh", "discs", "pullpush", "glass"):
    several, further = Png("several_%s.png" % name), Png("further_%s.png" % name)
    expect(several.pixels() == further.pixels(), name, "differs from several isovalues")
exact, raycast = Png("both_exact.png"), Png("both_raycast.png")
off = max(abs(x - y) for p, q in zip(exact.pixels(), raycast.pixels()) for x, y in zip(p, q))
expect(off <= 1, "exact and raycast differ by", off)
j = report("exact.json")
expect(j["isovalues"] == [500] and len(j["volumes"]) == 2, j["isovalues"], j["volumes"])
first, second = j["volumes"]
expect(first["path"] == "in/turned.mha" and first["isovalue"] == second["isovalue"] == 400, first, second)
# the radius is 10.8 voxels at 400; the voxels' first axis is along the world's y, the second one against its x
middle = (16 - 11.5 * 0.5, 2 + 11.5 * 0.6, 3 + 11.5 * 0.7)
for axis, spacing in enumerate((0.5, 0.6, 0.7)):
    low, high = first["bounds_world"][2 * axis:2 * axis + 2]
    expect(abs(low - middle[axis] + 10.8 * spacing) < 0.2 and abs(high - middle[axis] - 10.8 * spacing) < 0.2, axis, first)
expect(j["image"]["layers"]["most"] >= 4, j["image"]["layers"])
pair, alone = Png("pair.png"), Png("alone.png")
background = pair.rows[0][0]
expect([p == background for p in pair.pixels()] == [p == background for p in alone.pixels()], "pair")
expect("volume" not in report("pair.json") and len(report("pair.json")["volumes"]) == 2, "pair.json")
line = report("line.json")
expect(line["objects"][0]["samples"] > 100 and line["image"]["layers"]["most"] == 2, line["objects"], line["image"])
expect(report("mesh.json")["mesh"]["pieces"] == 1, "the mesh is of the input alone", report("mesh.json")["mesh"])
P
isorender in/ball.mha far.png --isovalue 500 --volume in/far.mha --volume-isovalue 500 2>notes
grep -q "note: in/far.mha lies beside the rest" notes
[ "$(grep -c "space" notes)" = 0 ]
isorender in/ball.mha --info --volume in/turned.mha >info
grep -q "^in/turned.mha" info
[ "$(grep -c "^  isovalues" info)" = 2 ]
isorender in/ball.mha --isovalue 500 --no-image --points points.ply --quiet
isorender_refuses 3 "in/none.mha: cannot read" in/ball.mha --volume in/none.mha
isorender_refuses 6 "in/turned.mha: no surface at isovalue 5000: values lie in" in/ball.mha --volume in/turned.mha --volume-isovalue 5000
isorender_refuses 2 "points.ply: holds points" in/ball.mha --volume points.ply
isorender_refuses 2 "--volume-opacity: '2' is not an opacity" in/ball.mha --volume in/ball.mha --volume-opacity 2
isorender_refuses 2 "--volume-isovalue: 'x' is neither" in/ball.mha --volume in/ball.mha --volume-isovalue x
isorender_refuses 2 "--volume-color: 'x' is neither" in/ball.mha --volume in/ball.mha --volume-color x
isorender_refuses 2 "--volume-color is for --volume" in/ball.mha --volume-color red
isorender_refuses 2 "--volume-color is given 2 times for 1 --volume" in/ball.mha --volume in/ball.mha --volume-color red --volume-color red
isorender_refuses 2 "cannot be combined with --volume" in/ball.mha --volume in/ball.mha --ior 1.5
isorender_refuses 2 "--method points cannot draw translucent" in/ball.mha --volume in/ball.mha --volume-opacity 0.5 --method points
isorender_refuses 2 "--isovalue is for an input" in/line.swc --isovalue 3 --volume in/ball.mha
cp in/turned.mha in/copy.mha
isorender_refuses 2 "overwrite" in/ball.mha --volume in/copy.mha --json=in/copy.mha
cmp in/turned.mha in/copy.mha
python3 -c 'from check import *; ball("in/large.mha", side=64)'
isorender_refuses 5 "in/large.mha: .*limit" in/ball.mha --isovalue 500 --resolution 8x8 --volume in/large.mha --max-memory 600K
