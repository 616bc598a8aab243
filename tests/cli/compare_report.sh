isocompare report scene:torus:32 --output made --side 64 --threads 2 2>log
grep -q 'isocompare: wrote made/report.html and report.json' log
isocompare report scene:torus:32 --output made --side 64 --quiet --isovalue 0.5 --background 202020
python3 - <<'P'
import base64
import re
from html.parser import HTMLParser
from check import *

page = open("made/report.html", encoding="utf-8").read()


class Page(HTMLParser):
    """Every element that is opened is closed, and nothing is fetched from elsewhere."""
    void = {"meta", "img", "br", "line", "rect", "circle"}
    may_stay_open = {"li", "dt", "dd", "p"}

    def __init__(self):
        super().__init__()
        self.open, self.images = [], []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        for key in ("src", "href"):
            if attributes.get(key):
                expect(attributes[key].startswith("data:"), tag, key, attributes[key][:60])
        if tag == "img" and attributes.get("src"):
            self.images.append(attributes["src"].split(",", 1)[1])
        if tag not in self.void:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        if tag in ("rect", "circle"):
            return
        while self.open and self.open[-1] != tag and self.open[-1] in self.may_stay_open:
            self.open.pop()
        expect(self.open and self.open[-1] == tag, "closes", tag, self.open)
        self.open.pop()


parser = Page()
parser.feed(page)
expect(not parser.open, parser.open)
j = report("made/report.json")
methods = {row["method"] for row in j["rows"]}
expect({"points", "mesh"} <= methods, methods)
expect(len(parser.images) == 3 * (1 + 2 * len(methods)), len(parser.images))
for i, image in enumerate(parser.images):
    with open("in/%d.png" % i, "wb") as file:
        file.write(base64.b64decode(image, validate=True))
    png = Png("in/%d.png" % i)
    expect((png.width, png.height) == (64, 64), i, png.width, png.height)
    drawn = i % (1 + 2 * len(methods)) <= len(methods)  # the rest are differences, and exact has none
    expect(not drawn or len(set(png.pixels())) > 3, "picture", i, "shows nothing")
for word in ("nan", "e+0"):
    expect(word not in re.sub("base64,[^\"]*", "", page), word, "in the page")
expect(page.count("<svg") == 6 and page.count("<table") == 10, page.count("<svg"), page.count("<table"))
expect("isocompare report torus --side=64 --isovalue=0.5 --background=202020" in page, "the command")

expect(j["schema"] == "isocompare-report/1" and j["isovalue"] == 0.5 and j["side"] == 64, j)
expect(len(j["rows"]) == 2 * 3 * len(methods) and len(j["frames"]) == 3 * (1 + len(methods)), len(j["rows"]))
for row in j["rows"]:
    expect((row["samples"], row["truth_samples"]) in ((1, 1), (4, 16)), row)
    expect(5 < float(row["psnr_in"]) and 0 <= row["flip"] < 1 and 0 < row["iou"] <= 1, row)
    expect((row["normal_error_deg"] is None) == (row["samples"] == 4), row)
for frame in j["frames"]:
    expect(frame["seconds"] > 0 and frame["pixels_per_voxel"] > 0, frame)
cost = j["cost"]
expect(cost["side"] == 800 and cost["viewports"] == [100, 200, 400, 800, 2048], cost)
expect(0.4 < cost["strip_indices"] < 0.7 and cost["edited_bricks"] == 4, cost["strip_indices"])
expect(0 < cost["crossed_bricks"] <= cost["bricks"] == 8, cost)
costs = {row["method"]: row for row in cost["rows"]}
expect(list(costs) == ["points", "pullpush", "mesh", "exact"], list(costs))
for row in cost["rows"]:
    expect(row["extraction_seconds"] > 0 and row["primitives"] > 500, row)
    for frame in [row["frame"], row["edited_frame"], *row["viewports"]]:
        expect(0 < frame["best_seconds"] and 0 < frame["seconds"] and frame["frames"] >= 6, frame)
parts = {part["part"]: part for part in j["extraction"]}
expect(parts["mesh"]["primitives"] > 1000 and parts["points"]["bytes"] > 0, parts)
P
