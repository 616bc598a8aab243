# Texts, arrows, rulers, legends and insets: where they are, that they leave the rest of the picture alone, and the same as pages of
# SVG and PDF, with text as text in its place, the picture's own pixels, and a page of the size that --dpi says.
python3 -c 'from check import *; ball("in/ball.mha", side=48, radius=10.0)'
printf '4 4 4\n40 40 40\n' >in/dots.xyz
view="--isovalue 500 --resolution 300x240 --orthographic --margin .2"
# ball: radius 10, middle at 23.5; the ruler lies beneath it
over="--text .5,.05:Ball --arrow 23.5,23.5,33.5:top --ruler 13.5,23.5,10,33.5,23.5,10 --scale-bar"
isorender in/ball.mha bare.png $view --quiet
isorender in/ball.mha over.png $view $over --json=over.json --quiet
isorender in/ball.mha over1.png $view $over --threads 1 --quiet
isorender --again over.png -o again.png --quiet
isorender in/ball.mha page.svg $view $over --dpi 144 --quiet
isorender in/ball.mha page1.svg $view $over --dpi 144 --threads 1 --quiet
isorender in/ball.mha page.pdf $view $over --dpi 144 --quiet
isorender in/ball.mha clear.pdf $view --text '50%,5%:Größe α ≥ 3 <&>' --background none --quiet
isorender in/ball.mha large.png $view --text .5,.1:Ball --font-size 20 --quiet
isorender in/ball.mha larger.png $view --text .5,.1:Ball --font-size 10 --dpi 144 --quiet
isorender in/ball.mha legend.png $view --isovalue 300 --opacity 1 --opacity .5 --color ff0000,00ff00 --legend=Core,Shell --quiet
isorender in/ball.mha named.svg $view --glyphs in/dots.xyz --glyph-radius 1 --legend --quiet
isorender in/ball.mha inset.png $view --inset .45,.45:.55,.55 --quiet
isorender in/ball.mha four.png --isovalue 500 --resolution 1200x960 --orthographic --margin .2 --quiet
isorender in/ball.mha - $view --quiet >stdout.png
isorender in/ball.mha far.png $view --text 0,0,900:gone 2>far.txt
cmp over.png over1.png
cmp over.png again.png
cmp page.svg page1.svg
cmp large.png larger.png && exit 1 # (they state their resolutions)
grep -q 'note: --text gone: its place is outside of the picture' far.txt
python3 - <<'P'
from check import *
import base64, re, xml.dom.minidom
bare, over = Png("bare.png"), Png("over.png")
expect(Png("large.png").rows == Png("larger.png").rows)
# what differs is beside the ball but for the arrow's head
changed = [(x, y) for y in range(240) for x in range(300) if bare.rows[y][x] != over.rows[y][x]]
scale = 1 / report("over.json")["camera"]["mm_per_pixel"] # pixels a mm
def place(x, z): return 150 + (x - 23.5) * scale, 120 - (z - 23.5) * scale
head, left, right = place(23.5, 33.5), place(13.5, 10), place(33.5, 10)
inside = [(x, y) for x, y in changed if (x - 149.5) ** 2 + (y - 119.5) ** 2 < (10 * scale - 12) ** 2]
expect(not inside, inside[:4], head)
# the ruler is black from its one end to the other, and 20 mm long
row = int(left[1])
black = [x for x in range(300) if over.rows[row][x][0] < 60 and abs(x - 150) < 11 * scale]
expect(abs(min(black) - left[0]) <= 1.5 and abs(max(black) - right[0]) <= 1.5, min(black), max(black), left, right)
# the page: its texts, sizes, and the picture in it
svg = xml.dom.minidom.parse("page.svg").documentElement
expect(svg.getAttribute("width") == "150pt" and svg.getAttribute("viewBox") == "0 0 300 240", svg.getAttribute("width"))
texts = {t.firstChild.data: t for t in svg.getElementsByTagName("text")}
bar = [t for t in texts if t not in ("Ball", "top", "20 mm")]
expect(set(texts) >= {"Ball", "top", "20 mm"} and len(bar) <= 1 and all(t.endswith(" mm") for t in bar), list(texts))
at, length = float(texts["Ball"].getAttribute("x")), float(texts["Ball"].getAttribute("textLength"))
expect(abs(at + length / 2 - 150) < 0.01, at, length)
image = svg.getElementsByTagName("image")[0].getAttribute("xlink:href")
open("embedded.png", "wb").write(base64.b64decode(image.split(",")[1]))
expect(Png("embedded.png").rows == bare.rows)
expect("dots" in open("named.svg").read() and "isovalue 500" in open("named.svg").read())
legend = Png("legend.png")
swatch = {legend.rows[y][x][:3] for y in range(60) for x in range(40)}
expect((255, 0, 0) in swatch and (0, 255, 0) in swatch, len(swatch))

class Pdf:
    """Objects of a PDF by the places that its table states; streams inflated."""
    def __init__(self, path):
        self.data = data = open(path, "rb").read()
        start = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data).group(1))
        count = int(re.match(rb"xref\n0 (\d+)\n", data[start:]).group(1))
        rows = data[start:].split(b"\n", 2)[2]
        self.objects = {}
        for i in range(1, count):
            at = int(rows[20 * i:20 * i + 10])
            expect(data[at:].startswith(b"%d 0 obj\n" % i), path, "object", i)
            self.objects[i] = data[at:data.index(b"endobj\n", at)]
    def stream(self, i):
        body = self.objects[i]
        begin = body.index(b"stream\n") + 7
        length = re.search(rb"/Length (\d+)( 0 R)?", body)
        size = int(length.group(1)) if not length.group(2) else int(self.objects[int(length.group(1))].split(b"\n")[1])
        expect(body[begin + size:].startswith(b"\nendstream\n"), "length of stream", i)
        return zlib.decompress(body[begin:begin + size])
    def texts(self):
        names = {a: bytes.fromhex(b.decode()).decode("utf-16-be") for a, b in re.findall(rb"<(\w{4})> <(\w{4})>\n", self.stream(9))}
        return ["".join(names[line[i:i + 4]] for i in range(0, len(line), 4)) for line in re.findall(rb"<(\w+)> Tj", self.stream(4))]
    def pixels(self, i, width):
        raw, rows, bpp = self.stream(i), [], 3
        before = bytes(width * bpp)
        for at in range(0, len(raw), width * bpp + 1):
            kind, line = raw[at], bytearray(raw[at + 1:at + 1 + width * bpp])
            for k in range(len(line)):
                a, b, c = line[k - bpp] if k >= bpp else 0, before[k], before[k - bpp] if k >= bpp else 0
                p = a + b - c
                paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[k] = (line[k] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
            rows.append(bytes(line))
            before = line
        return rows
page = Pdf("page.pdf")
expect(b"/MediaBox [0 0 150 120]" in page.data)
expect(sorted(page.texts()) == sorted(texts), page.texts(), list(texts))
expect(page.pixels(11, 300) == [b"".join(bytes(p[:3]) for p in row) for row in bare.rows])
clear = Pdf("clear.pdf")
expect(clear.texts() == ["Größe α ≥ 3 <&>"] and b"/SMask 12 0 R" in clear.objects[11], clear.texts())
alpha = clear.stream(12)
expect(len(alpha) == 300 * 240 and alpha[0] == 0 and alpha[120 * 300 + 150] == 255)
# the inset is that part of a picture that is four times as large, but for its frame
inset, four = Png("inset.png"), Png("four.png")
left, top, side, high = 300 - 4 - 120, 4, 120, 96
part = [row[4 * 135 + 3:4 * 165 - 3] for row in four.rows[4 * 108 + 3:4 * 132 - 3]]
expect([row[left + 3:left + side - 3] for row in inset.rows[top + 3:top + high - 3]] == part)
P
if command -v pdftotext >/dev/null; then pdftotext page.pdf - | grep -q '^20 mm$'; fi
refuses 2 "'.5' is not PLACE:TEXT" isorender in/ball.mha bad.png --text .5 || exit 1
refuses 2 "a text of 10000 characters; at most 400" isorender in/ball.mha bad.png --text ".5,.5:$(printf 'a%.0s' $(seq 10000))" || exit 1
refuses 2 "text from right to left cannot be drawn" isorender in/ball.mha bad.png --text ".5,.5:שלום" || exit 1
refuses 2 "(U+6F22) cannot be drawn" isorender in/ball.mha bad.png --arrow ".5,.5:漢" || exit 1
refuses 2 "the text is empty" isorender in/ball.mha bad.png --text .5,.5: || exit 1
refuses 2 "is not two points" isorender in/ball.mha bad.png --ruler 1,2,3 || exit 1
refuses 2 "both points are the same" isorender in/ball.mha bad.png --ruler 1,2,3,1,2,3 || exit 1
refuses 2 "it would not be larger" isorender in/ball.mha bad.png --inset 0,0:1,1 || exit 1
refuses 2 "is not X0,Y0:X1,Y1" isorender in/ball.mha bad.png --inset .1,.1:.2,.2:middle || exit 1
refuses 2 "3 names for 1 surfaces" isorender in/ball.mha bad.png --isovalue 500 --legend=a,b,c || exit 1
refuses 2 "cannot be combined with --part" isorender in/ball.mha --part 1/2 --text .5,.5:a || exit 1
rm -f said
