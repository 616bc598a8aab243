# Meshes are drawn in the colours of their vertices (.ply, .obj, .glb, .3mf): one colour is that of --surface-color, two are mixed between.
cat >make.py <<'P'
from check import *
corners = [(0, 0, 0), (40, 0, 0), (40, 0, 20), (0, 0, 20)] # faces the front
faces = [(0, 1, 2), (0, 2, 3)]

def ply(name, kind, names, colors):
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "".join("property %s %s\n" % (kind, n) for n in names)
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    rows = ["%g %g %g %s\n" % (*p, " ".join("%g" % v for v in c)) for p, c in zip(corners, colors)]
    open(name, "w").write(head + "".join(rows) + "".join("3 %d %d %d\n" % f for f in faces))

def obj(name, colors):
    rows = ["v %g %g %g %s\n" % (*p, " ".join("%.9g" % v for v in c)) for p, c in zip(corners, colors)]
    open(name, "w").write("".join(rows) + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in faces))

RGB, one = ("red", "green", "blue"), (192, 128, 64)
ply("plain.ply", "uchar", (), [()] * 4)
ply("bytes.ply", "uchar", RGB, [one] * 4)
ply("diffuse.ply", "uchar", ("diffuse_red", "diffuse_green", "diffuse_blue"), [one] * 4)
ply("floats.ply", "float", RGB, [[v / 255 for v in one]] * 4)
ply("large.ply", "float", RGB, [(192, 128, 1)] * 4) # as bytes: 1 is nearly black
obj("rows.obj", [[v / 255 for v in one]] * 4)
obj("some.obj", [[v / 255 for v in one]] * 3 + [()])
ply("two.ply", "uchar", RGB, [(255, 0, 0), (0, 0, 255), (0, 0, 255), (255, 0, 0)])

def linear(v):
    return v / 255 / 12.92 if v / 255 <= 0.04045 else ((v / 255 + 0.055) / 1.055) ** 2.4

def glb(name, colors, factor):
    """Corners in metres with y up; colours (floats, linear) of vertices and of the material, either may be None."""
    data = b"".join(struct.pack("<3f", x / 1000, z / 1000, -y / 1000) for x, y, z in corners)
    data += b"".join(struct.pack("<3B", *f) for f in faces) + b"\0\0"
    data += b"".join(struct.pack("<4f", *c, 1) for c in colors or [])
    views = [(0, 48), (48, 6), (56, 64)][:3 if colors else 2]
    types = [(5126, 4, "VEC3"), (5121, 6, "SCALAR"), (5126, 4, "VEC4")]
    primitive = {"attributes": {"POSITION": 0, **({"COLOR_0": 2} if colors else {})}, "indices": 1}
    if factor: primitive["material"] = 0
    top = {"asset": {"version": "2.0"}, "meshes": [{"primitives": [primitive]}], "buffers": [{"byteLength": len(data)}],
           "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [*(factor or (1, 1, 1)), 1]}}],
           "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
           "accessors": [{"bufferView": i, "componentType": t, "count": n, "type": k}
                         for i, (t, n, k) in enumerate(types[:len(views)])]}
    text = json.dumps(top).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    open(name, "wb").write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(data))
                           + struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(data)) + b"BIN\0" + data)

def threemf(name, resources, object, triangles):
    space = "http://schemas.microsoft.com/3dmanufacturing/"
    relations = ('<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target='
                 '"/3D/3d.model" Id="r" Type="%s2013/01/3dmodel"/></Relationships>' % space)
    vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % p for p in corners)
    rows = "".join('<triangle v1="%d" v2="%d" v3="%d"%s/>' % (*f, t) for f, t in zip(faces, triangles))
    with zipfile.ZipFile(name, "w") as z:
        z.writestr("_rels/.rels", relations)
        z.writestr("3D/3d.model", '<model unit="millimeter" xmlns="%score/2015/02" xmlns:m="%smaterial/2015/02"><resources>%s'
                   '<object id="9" type="model"%s><mesh><vertices>%s</vertices><triangles>%s</triangles></mesh></object>'
                   '</resources><build><item objectid="9"/></build></model>' % (space, space, resources, object, vertices, rows))

light = [linear(v) for v in one]
glb("vertices.glb", [light] * 4, None)
glb("material.glb", None, light)
glb("both.glb", [[v ** .5 for v in light]] * 4, [v ** .5 for v in light])
group = '<m:colorgroup id="3"><m:color color="#00FF00"/><m:color color="#C08040FF"/></m:colorgroup>'
threemf("group.3mf", group, "", [' pid="3" p1="1"', ' pid="3" p1="1" p2="1" p3="1"'])
threemf("base.3mf", '<basematerials id="1"><base name="a" displaycolor="#C08040"/></basematerials>', ' pid="1" pindex="0"', ["", ""])
threemf("default.3mf", group, ' pid="3" pindex="1"', ["", ' p1="1"'])
threemf("flat.3mf", '<m:colorgroup id="3"><m:color color="#FF0000"/><m:color color="#0000FF"/></m:colorgroup>', "",
        [' pid="3" p1="0"', ' pid="3" p1="1"'])
threemf("unused.3mf", group, "", ["", ""])
P
sed -i '1i import json, zipfile' make.py
python3 make.py
draw() { isorender --surface "$1" "$2.png" --camera front --resolution 90x50 --samples 1 --quiet --json="$2.json" "${@:3}"; }
same() { python3 -c 'from check import *
a, b = (report(n + ".json")["image"]["hash"] for n in sys.argv[1:3])
expect((a == b) == (sys.argv[3] == "yes"), sys.argv)' "$@"; }
draw plain.ply plain
draw plain.ply given --surface-color c08040
for file in bytes.ply diffuse.ply floats.ply rows.obj vertices.glb material.glb both.glb group.3mf base.3mf default.3mf; do
    draw $file own
    same own given yes
done
same own plain no
draw some.obj own # not all vertices have one
same own plain yes
draw unused.3mf own
same own plain yes
draw flat.3mf flat # triangles that share vertices keep their own colours
python3 -c 'from check import *
row = [p[:3] for p in Png("flat.png").rows[25] if p[:3] != (255, 255, 255)]
kinds = [p[0] > p[2] for p in row]
expect(len(row) > 40 and all(max(p) > 2 * sorted(p)[1] for p in row) and kinds.count(True) > 15 and kinds.count(False) > 15, row)
expect(sum(a != b for a, b in zip(kinds, kinds[1:])) == 1, kinds)'
draw large.ply own
draw plain.ply given --surface-color c08001
same own given yes
draw bytes.ply own --surface-color gold
draw plain.ply given --surface-color gold
same own given yes
for method in mesh raycast; do
    isorender scene:sphere:16 $method.png --surface two.ply --method $method --camera front --resolution 90x50 --quiet
done
draw two.ply two
python3 -c 'from check import *
row = [p for p in Png("two.png").rows[25] if p[:3] != (255, 255, 255)]
expect(len(row) > 40, len(row))
shares = [p[0] / (p[0] + p[2]) for p in row] # of red; the light is the same everywhere but for its highlight
expect(shares[0] > .9 and shares[-1] < .1, shares[0], shares[-1])
expect(all(a >= b - .02 for a, b in zip(shares, shares[1:])), shares)
middle = shares[len(shares) // 2]
expect(.4 < middle < .6, middle)'
