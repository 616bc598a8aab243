# .glb and .3mf as meshes: parts, places, strips, fans, types of numbers and units give the pictures of the .ply of the same
# triangles; what is damaged or not read is refused in one line.
cat >in/make.py <<'P'
import json, zipfile
from check import *
points = [(0, 0, 0), (40, 0, 0), (0, 30, 0), (0, 0, 20)] # a tetrahedron, mm
faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]

def ply(name, parts):
    vertices = [v for p, f in parts for v in p]
    triangles, first = [], 0
    for p, f in parts:
        triangles += [[first + i for i in t] for t in f]
        first += len(p)
    head = "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nelement face %d\n" \
           "property list uchar int vertex_indices\nend_header\n" % (len(vertices), len(triangles))
    open("in/" + name, "w").write(head + "".join("%r %r %r\n" % v for v in vertices) + "".join("3 %d %d %d\n" % tuple(t) for t in triangles))

moved = [(5 - 2 * y, 50 + 2 * x, 7 + 2 * z) for x, y, z in points] # twice as large, turned by 90 degrees about z, moved
mirrored = [(-10 - x, y, z) for x, y, z in points]
turned = [(a, c, b) for a, b, c in faces]
ply("one.ply", [(points, faces)])
ply("three.ply", [(points, faces), (moved, faces), (mirrored, turned)])

# ---- glTF: metres, y up
up = lambda p: (p[0] / 1000, p[2] / 1000, -p[1] / 1000)
def glb(name, top, data, version=2):
    top = {"asset": {"version": "2.0"}, **({"buffers": [{"byteLength": len(data)}]} if data else {}), **top}
    text = json.dumps(top).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    open("in/" + name, "wb").write(b"glTF" + struct.pack("<II", version, 12 + len(chunks)) + chunks)

def one(name, positions, kind, indices, code, mode=4, normalized=False, stride=0, nodes=None, scene=True, **more):
    """A mesh: positions of a type, as (code, number of glTF), and indices or None."""
    step = stride or 3 * struct.calcsize(kind[0])
    data = b"".join(struct.pack("<3" + kind[0], *p).ljust(step, b"\x7f") for p in positions)
    data += b"\0" * (-len(data) % 4)
    views = [{"buffer": 0, "byteLength": len(data), **({"byteStride": stride} if stride else {})}]
    accessors = [{"bufferView": 0, "componentType": kind[1], "count": len(positions), "type": "VEC3", **({"normalized": True} if normalized else {})}]
    primitive = {"attributes": {"POSITION": 0}, "mode": mode}
    if indices:
        packed = struct.pack("<%d%s" % (len(indices), code[0]), *indices)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessors.append({"bufferView": 1, "componentType": code[1], "count": len(indices), "type": "SCALAR"})
        primitive["indices"] = 1
        data += packed
    top = {"bufferViews": views, "accessors": accessors, "meshes": [{"primitives": [primitive]}], "nodes": nodes or [{"mesh": 0}]}
    if scene:
        top |= {"scene": 0, "scenes": [{"nodes": [0]}]}
    glb(name, {**top, **more}, data)

F, I16, U8, U16, U32 = ("f", 5126), ("h", 5122), ("B", 5121), ("H", 5123), ("I", 5125)
list_of = [i for f in faces for i in f]
flat = [up(points[i]) for i in list_of]
metres = [up(p) for p in points]
one("bytes.glb", metres, F, list_of, U8)
one("shorts.glb", metres, F, list_of, U16)
one("ints.glb", metres, F, list_of, U32, stride=20)
one("no_indices.glb", flat, F, None, None)
one("no_scene.glb", metres, F, list_of, U8, scene=False)
one("strip.glb", metres, F, [0, 2, 1, 3, 0, 2], U8, mode=5)
one("fan.glb", metres, F, [0, 2, 1, 3, 2], U8, mode=6)
one("whole.glb", [tuple(round(1000 * v) for v in p) for p in metres], I16, list_of, U8, nodes=[{"mesh": 0, "scale": [.001] * 3}],
    extensionsRequired=["KHR_mesh_quantization"])
one("normalized.glb", [tuple(round(v / .04 * 32767) for v in p) for p in metres], I16, list_of, U8, normalized=True,
    nodes=[{"mesh": 0, "scale": [.04] * 3}])
half = 2 ** -.5
one("nodes.glb", metres, F, list_of, U8, nodes=[{"children": [1, 2, 4]}, {"mesh": 0},
    {"rotation": [0, half, 0, half], "translation": list(up((5, 50, 7))), "children": [3]}, {"mesh": 0, "scale": [2, 2, 2]},
    {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -.01, 0, 0, 1]}])
fan = [(0, 2, 1), (0, 1, 3), (0, 3, 2)]
strip = [(0, 2, 1), (2, 3, 1), (1, 3, 0), (3, 2, 0)]
ply("fan.ply", [(points, fan)])
ply("strip.ply", [(points, strip)])

one("cycle.glb", metres, F, list_of, U8, nodes=[{"children": [1]}, {"mesh": 0, "children": [0]}])
one("beyond.glb", metres, F, [0, 1, 4], U8)
one("draco.glb", metres, F, list_of, U8, extensionsRequired=["KHR_draco_mesh_compression"])
one("infinite.glb", [(1e39 * 0 + v for v in p) for p in metres[:3]] + [(float("nan"), 0, 0)], F, list_of, U8)
one("elsewhere.glb", metres, F, list_of, U8, buffers=[{"byteLength": 60, "uri": "a.bin"}])
one("long.glb", metres, F, list_of, U8, accessors=[{"bufferView": 0, "componentType": 5126, "count": 1000000, "type": "VEC3"}] * 2)
one("points.glb", metres, F, None, None, mode=0)
glb("old.glb", {}, b"", version=1)

# ---- 3MF
HEAD = '<?xml version="1.0"?><model unit="%s" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
RELATIONS = '<Relationships><Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" Target="/3D/a.model" Id="r"/></Relationships>'
def threemf(name, models, method=zipfile.ZIP_DEFLATED, relations=RELATIONS):
    with zipfile.ZipFile("in/" + name, "w", method) as z:
        z.writestr("_rels/.rels", relations)
        for path, text in models.items():
            z.writestr(path, text)
def mesh(number, p, f):
    return '<object id="%d"><mesh><vertices>%s</vertices><triangles>%s</triangles></mesh></object>' % (number,
        "".join('<vertex x="%r" y="%r" z="%r"/>' % v for v in p), "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in f))
def model(objects, items, unit="millimeter"):
    return HEAD % unit + "<resources>%s</resources><build>%s</build></model>" % (objects, items)
TWICE, MIRROR = "0 2 0 -2 0 0 0 0 2 5 50 7", "-1 0 0 0 1 0 0 0 1 -10 0 0"
plain = model(mesh(3, points, faces), '<item objectid="3"/>')
threemf("plain.3mf", {"3D/a.model": plain})
threemf("stored.3mf", {"3D/A.model": plain}, zipfile.ZIP_STORED)
threemf("inches.3mf", {"3D/a.model": model(mesh(3, [tuple(v / 25.4 for v in p) for p in points], faces), '<item objectid="3"/>', "inch")})
threemf("items.3mf", {"3D/a.model": model(mesh(3, points, faces), '<item objectid="3"/><item objectid="3" transform="%s"/><item objectid="3" transform="%s"/>' % (TWICE, MIRROR))})
component = '<object id="7"><components><component objectid="3"/><component objectid="3" transform="%s"/><component objectid="3" transform="%s"/></components></object>' % (TWICE, MIRROR)
threemf("components.3mf", {"3D/a.model": model(mesh(3, points, faces) + component, '<item objectid="7"/>')})
other = component.replace("objectid", 'p:path="/3D/Objects/b.model" objectid')
threemf("models.3mf", {"3D/a.model": model(other, '<item objectid="7"/>'), "3D/Objects/b.model": model(mesh(3, points, faces), "")})
threemf("cycle.3mf", {"3D/a.model": model('<object id="1"><components><component objectid="1"/></components></object>', '<item objectid="1"/>')})
threemf("lost.3mf", {"3D/a.model": model(mesh(3, points, faces), '<item objectid="4"/>')})
threemf("beyond.3mf", {"3D/a.model": model(mesh(3, points, faces + [(1, 2, 4)]), '<item objectid="3"/>')})
threemf("unit.3mf", {"3D/a.model": plain.replace("millimeter", "league")})
threemf("rubbish.3mf", {"3D/a.model": plain.replace('x="40"', 'x="4_0"')})
threemf("none.3mf", {"3D/b.txt": plain})
threemf("beams.3mf", {"3D/a.model": model(mesh(3, points, []), '<item objectid="3"/>')})
# objects that double 20 times, and one of 20 levels without triangles
nested = "".join('<object id="%d"><components><component objectid="%d"/><component objectid="%d"/></components></object>' % (i, i + 1, i + 1) for i in range(1, 22))
threemf("many.3mf", {"3D/a.model": model(nested + '<object id="22"/>', '<item objectid="1"/>')})
bytes = bytearray(open("in/stored.3mf", "rb").read())
bytes[bytes.index(b'x="40"') + 3] = ord("5")
open("in/checksum.3mf", "wb").write(bytes)
P
python3 in/make.py

same() { # REFERENCE FILE: both are drawn alike from two sides
    local camera
    for camera in "30 20" "210 -35"; do
        isorender --surface "in/$1" a.png --azimuth "${camera% *}" --elevation "${camera#* }" --resolution 80x80 --quiet --json=a.json
        isorender --surface "in/$2" b.png --azimuth "${camera% *}" --elevation "${camera#* }" --resolution 80x80 --quiet --json=b.json
        python3 -c 'from check import *
expect(report("a.json")["image"]["hash"] == report("b.json")["image"]["hash"], sys.argv)' "$@"
    done
}
for file in bytes shorts ints no_indices no_scene whole; do same one.ply $file.glb; done
same strip.ply strip.glb
same fan.ply fan.glb
same three.ply nodes.glb
for file in plain stored inches; do same one.ply $file.3mf; done
for file in items components models; do same three.ply $file.3mf; done
isorender --surface in/normalized.glb --info | grep -q '0 0 0 .. 40 29.9997 20.0006 mm' # in steps of .04 m / 32767
cp in/bytes.glb in/no_extension
same one.ply no_extension

# what is written is read
isorender scene:sphere:24 --no-image --mesh in/m.ply --quiet
for kind in glb 3mf; do
    isorender scene:sphere:24 --no-image --mesh in/m.$kind --quiet
    same m.ply m.$kind
done

bad() { isorender_refuses "$1" "in/$2" --surface "in/${2%%:*}"; }
bad 3 'cycle.glb: not a readable .glb file: its nodes are not a tree'
bad 3 'beyond.glb: a triangle names vertex 4 of 4'
bad 3 "draco.glb: needs glTF's extension KHR_draco_mesh_compression, which is not read: export it without"
bad 3 'infinite.glb: vertex 4 is not finite'
bad 3 'elsewhere.glb: its vertices are in another file: a .glb that holds them is read'
bad 3 'long.glb: not a readable .glb file: an accessor reaches beyond its bytes'
bad 6 'points.glb: holds no triangles'
bad 3 'old.glb: glTF 1 is not read, glTF 2 is'
bad 3 'cycle.3mf: not a readable 3MF file: its objects contain each other'
bad 3 'lost.3mf: not a readable 3MF file: an object that it uses is not there'
bad 3 'beyond.3mf: a triangle names vertex 4 of 4'
bad 3 'unit.3mf: not a readable 3MF file: a unit that 3MF does not have'
bad 3 'rubbish.3mf: not a readable 3MF file: a vertex without three numbers'
bad 3 'none.3mf: not a readable 3MF file: it holds no model'
bad 6 'beams.3mf: holds no triangles'
bad 5 'many.3mf: more than 1048576 objects are built'
bad 3 'checksum.3mf: a damaged ZIP archive: the checksum of a file is wrong'
for file in ints.glb items.3mf; do
    size=$(stat -c %s in/$file)
    for percent in $(seq 5 10 95); do
        head -c $((size * percent / 100)) in/$file >in/cut.${file#*.}
        isorender_refuses 3 "in/cut.${file#*.}: .*" --surface in/cut.${file#*.}
    done
done
