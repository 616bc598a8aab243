# What the blocks of LAS files say: units of the coordinates, and further columns. Files that state no unit have none.
python3 - <<'P'
import struct
def block(user, number, body):
    return struct.pack("<H16sHH32s", 0, user, number, len(body), b"") + body
def las(path, blocks, extra=lambda k: b"", points=[(k % 8, k // 8, (k * k) % 5) for k in range(64)]):
    size = 20 + len(extra(0))
    body = b"".join(blocks)
    head = bytearray(227)
    head[0:4], head[24], head[25] = b"LASF", 1, 2
    struct.pack_into("<HIIBHI", head, 94, 227, 227 + len(body), len(blocks), 0, size, len(points))
    struct.pack_into("<6d", head, 131, 1, 1, 1, 0, 0, 0)
    open("in/%s.las" % path, "wb").write(bytes(head) + body
        + b"".join(struct.pack("<3i8x", *p) + extra(k) for k, p in enumerate(points)))
def keys(*pairs):
    return block(b"LASF_Projection", 34735, struct.pack("<4H", 1, 1, 0, len(pairs)) + b"".join(struct.pack("<4H", k, 0, 1, v) for k, v in pairs))
def text(wkt, user=b"LASF_Projection"):
    return block(user, 2112, wkt.encode() + b"\0")
degree = 'GEOGCS["g",DATUM["d",SPHEROID["s",6378137,298]],UNIT["degree",0.0174532925199433]]'
las("none", [])
las("metre", [keys((1024, 1), (3072, 2154), (3076, 9001))])
las("utm", [keys((1024, 1), (3072, 32617))])
las("foot", [keys((1024, 1), (3076, 9002))])
las("degree", [keys((1024, 2), (2048, 4326))])
las("wkt_metre", [text('COMPD_CS["c",PROJCS["p",%s,PROJECTION["t"],UNIT["metre",1,AUTHORITY["EPSG","9001"]]],VERT_CS["v",UNIT["ft",0.3048]]]' % degree)])
las("wkt_foot", [text('PROJCS["p",%s,PROJECTION["t"],UNIT["foot_survey_us",0.304800609601219]]' % degree, b"liblas")])
las("wkt_degree", [text(degree)])
las("wkt2_metre", [text('PROJCRS["p",BASEGEOGCRS["b"],CONVERSION["c",PARAMETER["a",0,ANGLEUNIT["degree",0.01745]]],CS[Cartesian,2],LENGTHUNIT["metre",1]]')])
las("wkt_cut", [text('PROJCS["p",UNIT["met')])
def extra(kind, options, name, no_data=b"", scale=(0, 0, 0), shift=(0, 0, 0)):
    return struct.pack("<HBB32s4x24s48x3d3d32x", 0, kind, options, name, no_data, *scale, *shift)
spec = block(b"LASF_Spec", 4, extra(4, 1 | 8 | 16, b"reflectance", struct.pack("<q", -7), (.01, 0, 0), (5, 0, 0))
             + extra(0, 3, b"secret") + extra(23, 0, b"triple") + extra(9, 0, b"real") + extra(10, 0, b"beyond the record"))
las("extra", [spec], lambda k: struct.pack("<h3x3Hf", -7 if k == 9 else k, 3, 0, 4, k / 2))
P
unit() { # FILE UNIT TEXT: --info says "spacing 1UNIT between", the report names the unit
    isorender --info "in/$1.las" >info 2>said && grep -q "spacing *1$2 between" info || { cat info; exit 1; }
    ! grep -q ' mm' info
}
unit none ''; unit wkt_cut ''
unit metre ' m'; unit utm ' m'; unit wkt_metre ' m'; unit wkt2_metre ' m'
unit foot ' ft'; unit wkt_foot ' ft'
unit degree ' deg'; grep -q 'note: its x and y are degrees' said
unit wkt_degree ' deg'
isorender in/metre.las m.png --json=m.json --quiet --resolution 60x60 --orthographic --scale-bar
isorender in/none.las n.png --json=n.json --quiet --resolution 60x60 --orthographic --scale-bar
isorender --info in/extra.las >info
python3 - <<'P'
from check import *
info = open("info").read()
for text in ("reflectance: 5 .. 5.63", "triple, 3 numbers: 5 .. 5 (lengths)", "real: 0 .. 31.5"):
    expect(text in info, text, info)
expect("secret" not in info and "beyond" not in info, info)
m, n = report("m.json"), report("n.json")
expect([j["primitives"]["unit"] for j in (m, n)] == ["m", None], m["primitives"])
expect("scale_bar_mm" not in m and m["scale_bar"] == n["scale_bar"] == 2, m["scale_bar"])
expect(Png("m.png").rows != Png("n.png").rows, "the scale bars are labelled alike")
P
isorender in/extra.las e.png --quiet --resolution 60x60 --color-by reflectance --color-bar
isorender in/extra.las z.png --quiet --resolution 60x60 --color-by z --color-bar='height (m)' # coordinates are columns
isorender in/extra.las x.png --quiet --resolution 60x60 --color-by x --color-bar='height (m)'
if cmp -s z.png x.png; then echo "coloured alike by x and z"; exit 1; fi
