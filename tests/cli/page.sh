# stdout: *
# stderr: *
# Pages have the same bytes for every number of threads, whole or not at all, names of files escaped, no folders and no addresses in
# them, and no voxels but those that the range of isovalues needs.
name='a<b>&"'\''{{VOXELS}}</script>$(x).nrrd'
mkdir -p in/secret
python3 - "in/secret/${name//\//:}" <<'END'
import struct, sys
from check import *
n = 32
voxels = [int(1000 - 4 * ((x - 15) ** 2 + (y - 15.5) ** 2 + (z - 16) ** 2)) for z in range(n) for y in range(n) for x in range(n)]
header = "NRRD0004\n# patient: Doe^Jane\ntype: short\ndimension: 3\nsizes: %d %d %d\nendian: little\nencoding: raw\nspace: left-posterior-superior\n" \
         "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n\n" % (n, n, n)
open(sys.argv[1], "wb").write(header.encode() + struct.pack("<%dh" % len(voxels), *voxels))
END
volume=in/secret/${name//\//:}
code=0
isorender "$volume" a.html --isovalue 500 --isovalue-range 400,600 --threads 1 2>said || code=$?
if [ $code -eq 4 ] && grep -q 'built without pages' said; then exit 77; fi
[ $code -eq 0 ] || { cat said; exit 1; }
grep -q 'who has the page has these' said || { echo "nothing is said about privacy"; exit 1; }
isorender "$volume" b.html --isovalue 500 --isovalue-range 400,600 --threads 3 --quiet || exit 1
cmp a.html b.html || exit 1
# a page that would be too large, or cannot be written, leaves what was there
refuses 5 'bad.html: the voxels of this range of isovalues take more than .* --isovalue-range may be narrower' isorender scene:ct:96 bad.html --isovalue 130 --isovalue-range 0,250 --page-size 260K || exit 1
ln -s /dev/full in/full.html
refuses 7 'in/full.html: cannot write: ' isorender scene:ct:32 in/full.html || exit 1
cp a.html kept.html
isorender scene:ct:96 kept.html --isovalue 130 --isovalue-range 0,250 --page-size 260K 2>said && exit 1
cmp a.html kept.html || exit 1
# the range that is chosen fits
isorender scene:ct:96 chosen.html --isovalue 130 --page-size 600K --quiet || exit 1
isorender scene:ct:32 all.html --quiet || exit 1
python3 - "$(basename "$volume")" <<'END'
import base64, gzip, html.parser, json, os, struct, sys
from check import *

class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.text, self.parts, self.open, self.tags = open(path, encoding="utf-8").read(), {}, None, []
        self.feed(self.text)
    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.open = dict(attributes).get("id") or tag
    def handle_endtag(self, tag):
        self.open = None
    def handle_data(self, data):
        self.parts[self.open] = self.parts.get(self.open, "") + data

page = Page("a.html")
facts = json.loads(page.parts["facts"])
expect(facts["name"] == sys.argv[1] == page.parts["title"], "name", facts["name"], page.parts["title"])
expect(page.tags.count("b") == 0 and page.tags.count("script") == 8, "the name is not escaped", page.tags)
for word in ("secret", "Doe^", "^Jane", os.getcwd(), "://"):  # (three letters alone stand somewhere in base64)
    expect(word not in page.text, word, "is in the page")
expect(len(page.parts["engine"]) <= 120000, "engine", len(page.parts["engine"]))
engine = gzip.decompress(base64.b64decode(page.parts["engine"]))
expect(engine[:4] == b"\0asm", "no engine")
voxels = struct.unpack("<%dh" % 32 ** 3, gzip.decompress(base64.b64decode(page.parts["voxels"])))
truth = [int(1000 - 4 * ((x - 15) ** 2 + (y - 15.5) ** 2 + (z - 16) ** 2)) for z in range(32) for y in range(32) for x in range(32)]
others = [(v, t) for v, t in zip(voxels, truth) if v != t]
expect(len(others) > 20000 and {v for v, _ in others} == {399, 600}, "voxels", len(others), {v for v, _ in others})
expect(all((v < 400) == (t < 400) and (v < 600) == (t < 600) for v, t in others), "sides")
chosen = Page("chosen.html")
low, high = json.loads(chosen.parts["facts"])["volume"]["range"]
expect(low < 130 < high and 400000 < len(chosen.text) <= 600 * 1024, "chosen", low, high, len(chosen.text))
expect(len(Page("all.html").text) < 8e6, "all")
END
