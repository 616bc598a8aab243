# --mesh as .glb, .3mf and .vtp: what is in the files, and what their readers say if they are there.
cat >in/files.py <<'P'
import json, struct, sys, zipfile, re
import xml.etree.ElementTree as xml
from check import *
def single(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]
WIDTHS, SIZES = {"VEC3": 3, "VEC4": 4, "SCALAR": 1}, {5126: 4, 5123: 2, 5125: 4}
def check_rules(path, top, bytes):
    """What the Khronos validator looks at, as far as such files have it: extents, alignment, references, roots."""
    expect(top["asset"]["version"] == "2.0" and "extensionsRequired" not in top and len(top["buffers"]) == 1, path)
    end = 0
    for i, view in enumerate(top["bufferViews"]):
        expect(view["buffer"] == 0 and view["byteLength"] > 0 and view["byteOffset"] == end and "byteStride" not in view, i, view)
        end = view["byteOffset"] + view["byteLength"]
    expect(end == bytes, path, "views end at", end, "of", bytes)
    for i, a in enumerate(top["accessors"]):
        view, step = top["bufferViews"][a["bufferView"]], WIDTHS[a["type"]] * SIZES[a["componentType"]]
        at = view["byteOffset"] + a.get("byteOffset", 0)
        expect(a["count"] > 0 and a.get("byteOffset", 0) + a["count"] * step <= view["byteLength"], "accessor", i, "is too long")
        expect(at % SIZES[a["componentType"]] == 0 and (view["target"] != 34962 or (at % 4 == 0 and step % 4 == 0)), "accessor", i, at)
    used = []
    for mesh in top["meshes"]:
        for p in mesh["primitives"]:
            expect(p.get("mode", 4) == 4 and set(p["attributes"]) <= {"POSITION", "NORMAL", "COLOR_0"}, p)
            count = {top["accessors"][a]["count"] for a in p["attributes"].values()}
            expect(len(count) == 1, "attributes of", count, "vertices")
            for name, a in p["attributes"].items():
                accessor = top["accessors"][a]
                expect(top["bufferViews"][accessor["bufferView"]]["target"] == 34962, name)
                kind = ("VEC4", 5123, True) if name == "COLOR_0" else ("VEC3", 5126, False)
                expect((accessor["type"], accessor["componentType"], accessor.get("normalized", False)) == kind, name, accessor)
            expect("min" in top["accessors"][p["attributes"]["POSITION"]], "positions have no bounds")
            index = top["accessors"][p["indices"]]
            expect((index["type"], index["componentType"], index["count"] % 3) == ("SCALAR", 5125, 0), index)
            expect(top["bufferViews"][index["bufferView"]]["target"] == 34963 and 0 <= p["material"] < len(top["materials"]), p)
            used += [p["indices"], *p["attributes"].values()]
    expect(sorted(used) == list(range(len(top["accessors"]))), "accessors that nothing uses")
    children = [c for node in top["nodes"] for c in node.get("children", [])]
    roots = top["scenes"][top["scene"]]["nodes"]
    expect(sorted(children + roots) == list(range(len(top["nodes"]))), "nodes", children, roots)
    expect(sorted(n["mesh"] for n in top["nodes"] if "mesh" in n) == list(range(len(top["meshes"]))), "meshes that nothing shows")
    for m in top["materials"]:
        factors = m.get("pbrMetallicRoughness", {})
        expect(all(0 <= c <= 1 for c in factors.get("baseColorFactor", [1, 1, 1, 1])), m)
        expect(m.get("alphaMode", "OPAQUE") in ("OPAQUE", "BLEND"), m)
def glb(path):
    data = open(path, "rb").read()
    magic, version, length, json_length, json_kind = struct.unpack("<5I", data[:20])
    expect(magic == 0x46546C67 and version == 2 and length == len(data) and json_kind == 0x4E4F534A, path, "header")
    top = json.loads(data[20:20 + json_length])
    binary_length, kind = struct.unpack("<2I", data[20 + json_length:28 + json_length])
    expect(kind == 0x004E4942 and binary_length == len(data) - 28 - json_length == top["buffers"][0]["byteLength"], path)
    expect(json_length % 4 == 0 and binary_length % 4 == 0, path, "chunks are not aligned")
    binary = data[28 + json_length:]
    check_rules(path, top, binary_length)
    def read(number):
        a = top["accessors"][number]
        v = top["bufferViews"][a["bufferView"]]
        width = {"VEC3": 3, "VEC4": 4, "SCALAR": 1}[a["type"]]
        code = {5126: "f", 5123: "H", 5125: "I"}[a["componentType"]]
        values = struct.unpack_from("<%d%s" % (width * a["count"], code), binary, v["byteOffset"])
        expect(v["byteLength"] == struct.calcsize("<%d%s" % (width * a["count"], code)), "view", number)
        return [values[i:i + width] for i in range(0, len(values), width)], a
    objects = {}
    for node in top["nodes"][1:]:
        primitive = top["meshes"][node["mesh"]]["primitives"][0]
        made = {name: read(a)[0] for name, a in primitive["attributes"].items()}
        made["triangles"] = [t[0] for t in read(primitive["indices"])[0]]
        accessor = read(primitive["attributes"]["POSITION"])[1]
        for axis in range(3):
            column = [p[axis] for p in made["POSITION"]]
            expect(single(accessor["min"][axis]) == min(column) and single(accessor["max"][axis]) == max(column), "bounds")
        expect(all(abs(sum(c * c for c in n) - 1) < 1e-5 for n in made["NORMAL"]), "normals")
        expect(max(made["triangles"]) < len(made["POSITION"]), "indices")
        made["material"] = top["materials"][primitive["material"]]
        objects[node["name"]] = made
    return top, objects
def threemf(path):
    z = zipfile.ZipFile(path)
    expect(z.testzip() is None and set(z.namelist()) == {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"}, path)
    for name in z.namelist():
        xml.fromstring(z.read(name))
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    model = xml.fromstring(z.read("3D/3dmodel.model"))
    expect(model.get("unit") == "millimeter", "unit")
    objects = {o.get("name"): o for o in model.iter(core + "object")}
    expect([i.get("objectid") for i in model.iter(core + "item")] == [o.get("id") for o in objects.values()], "build")
    return model, {name: ([tuple(float(v.get(a)) for a in "xyz") for v in o.iter(core + "vertex")],
                          [tuple(int(t.get(a)) for a in ("v1", "v2", "v3")) for t in o.iter(core + "triangle")])
                   for name, o in objects.items()}
def volume_of(points, triangles):
    total = 0
    for a, b, c in triangles:
        p, q, r = points[a], points[b], points[c]
        total += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) + p[2] * (q[0] * r[1] - q[1] * r[0])) / 6
    return total
def is_closed(triangles):
    edges = set()
    for t in triangles:
        for i in range(3):
            edge = (t[i], t[(i + 1) % 3])
            if edge in edges: return False
            edges.add(edge)
    return all((b, a) in edges for a, b in edges)
def threes(flat):
    return [tuple(flat[i:i + 3]) for i in range(0, len(flat), 3)]
P
export PYTHONPATH=$PYTHONPATH:$PWD/in
python3 - <<'P'
from check import *
ball("in/ball.mha")
volume("in/heat.mha", (24, 24, 24), lambda x, y, z: float(x))
P
out="--no-image --quiet"
isorender in/ball.mha --mesh two.glb --isovalue '400,600' --color '804020,ivory' --opacity '0.5,1' $out
isorender in/ball.mha --mesh two.3mf --isovalue '400,600' --color '804020,ivory' --opacity '0.5,1' $out
isorender in/ball.mha --mesh two.obj --isovalue '400,600' $out
[ "$(grep -c '^o ball isovalue' two.obj)" = 2 ]
isorender in/ball.mha --mesh heat.glb --isovalue 500 --surface-color-by in/heat.mha $out
isorender in/ball.mha --mesh heat.3mf --isovalue 500 --surface-color-by in/heat.mha $out
isorender in/ball.mha --mesh heat.vtp --isovalue 500 --surface-color-by in/heat.mha $out
isorender in/ball.mha --mesh heat.ply --isovalue 500 --surface-color-by in/heat.mha $out
python3 - <<'P'
from files import *
top, objects = glb("two.glb")
expect(list(objects) == ["ball isovalue 400", "ball isovalue 600"], list(objects))
expect(top["nodes"][0]["children"] == [1, 2] and top["nodes"][0]["scale"] == [0.001] * 3, top["nodes"])
first = objects["ball isovalue 400"]
color = first["material"]["pbrMetallicRoughness"]["baseColorFactor"]
expect(first["material"]["alphaMode"] == "BLEND" and color[3] == 0.5, first["material"])
expect(all(abs(c - ((v / 255 + 0.055) / 1.055) ** 2.4) < 1e-4 for c, v in zip(color, (0x80, 0x40, 0x20))), color)
model, parts = threemf("two.3mf")
expect(list(parts) == list(objects), list(parts))
for name, o in objects.items():
    expect(threes(o["triangles"]) == parts[name][1] and [tuple(p) for p in o["POSITION"]] ==
           [tuple(map(single, p)) for p in parts[name][0]], name)
    expect(is_closed(parts[name][1]) and volume_of(*parts[name]) > 0, name)
text = zipfile.ZipFile("two.3mf").read("3D/3dmodel.model").decode()
expect('displaycolor="#80402080"' in text and 'displaycolor="#FFFFF0FF"' in text, "colours")
top, objects = glb("heat.glb")
(o,) = objects.values()
ply = open("heat.ply", "rb").read()
body = ply[ply.index(b"end_header\n") + 11:]
for i, (position, linear) in enumerate(zip(o["POSITION"], o["COLOR_0"])):
    *p, r, g, b = struct.unpack_from("<3f12x3B", body, 27 * i)
    expect(tuple(p) == tuple(position), i)
    want = [65535 * (v / 255 / 12.92 if v <= 10 else ((v / 255 + 0.055) / 1.055) ** 2.4) for v in (r, g, b)]
    expect(all(abs(w - c) < 2 for w, c in zip(want, linear)) and linear[3] == 65535, i, want, linear)
text = zipfile.ZipFile("heat.3mf").read("3D/3dmodel.model").decode()
expect(text.count("<m:color ") == len(o["POSITION"]) and text.count(" p1=") == len(o["triangles"]) // 3, "colours")
P
# our reader of .vtp sees the same mesh as that of .ply
for type in vtp ply; do isorender --surface heat.$type $type.png --resolution 90x90 --quiet --surface-color ivory; done
isocompare images vtp.png ply.png --quiet --fail-under psnr=200
isosculpt --open heat.vtp --voxel-size 1 --headless --output in/h.vdb --quiet 2>/dev/null || [ $? -eq 3 ]
# labels: an object each
isorender scene:organs:48 --smooth --mesh organs.glb $out
isorender scene:organs:48 --smooth --mesh organs.3mf $out
python3 - <<'P'
from files import *
objects, parts = glb("organs.glb")[1], threemf("organs.3mf")[1]
expect(len(objects) > 2 and list(objects) == list(parts) and all(is_closed(t) for _, t in parts.values()), list(objects))
P
# what a format does not hold
refuses 2 "holds one surface: give one isovalue, or an .obj, .glb or .3mf" isorender in/ball.mha --mesh bad.stl --isovalue 400,600 $out
refuses 2 "such a file has no opacities" isorender in/ball.mha --mesh bad.obj --isovalue 400 --opacity 0.5 $out
# the judges: lib3mf's reader, strictly, and the Khronos validator, if they are there
python3 - <<'P'
import ctypes
from files import *
try:
    lib = ctypes.CDLL("lib3MF.so.1")
except OSError:
    print("no lib3MF.so.1 of Debian's lib3mf1: .3mf files are not read by it")
    raise SystemExit
def call(name, *values):
    status = getattr(lib, "lib3mf_" + name)(*values)
    expect(status == 0, name, hex(status & 0xffffffff))
def query(name, owner, *values, kind=ctypes.c_void_p):
    made = kind()
    call(name, *owner, *values, ctypes.byref(made))
    return made
for name in ("two", "heat", "organs"):
    model = query("createmodel", ())
    reader = query("model_queryreader", (model,), b"3mf")
    call("reader_setstrictmodeactive", reader, True)
    call("reader_readfromfileutf8", reader, ("%s.3mf" % name).encode())
    expect(query("reader_getwarningcount", (reader,), kind=ctypes.c_uint32).value == 0, name, "has warnings")
    wanted = [len(t) for _, t in threemf("%s.3mf" % name)[1].values()]
    meshes, found = query("model_getmeshobjects", (model,)), []
    while query("resourceiterator_movenext", (meshes,), kind=ctypes.c_int).value:
        mesh = query("resourceiterator_getcurrent", (meshes,))
        found.append(query("meshobject_gettrianglecount", (mesh,), kind=ctypes.c_uint32).value)
        expect(query("object_isvalidobject", (mesh,), kind=ctypes.c_int).value, name, "has an invalid object")
        expect(query("meshobject_ismanifoldandoriented", (mesh,), kind=ctypes.c_int).value, name, "is not manifold")
    expect(found == wanted, name, found, wanted)
P
[ -d "${GLTF_VALIDATOR:-}" ] && for file in two heat organs; do
    node -e 'const v = require(process.argv[1]); v.validateBytes(new Uint8Array(require("fs").readFileSync(process.argv[2]))).then(r => {
        if (r.issues.numErrors + r.issues.numWarnings) { console.log(JSON.stringify(r.issues)); process.exit(1); } })' "$GLTF_VALIDATOR" $file.glb
done
true
