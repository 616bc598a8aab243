# The report's numbers from the papers, on volumes of uint8, of int16, a level set and a stroke file: points that are
# selected, splats in groups (as isorender has them), layers at three opacities, and the three tables of 2003.
strokes=$volumes/../tests/hostile/ball.strokes
python3 - <<'P'
from check import *
middle = 15.5


def distance(x, y, z):
    return ((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2) ** 0.5


volume("in/bytes.mha", (32, 32, 32), lambda *at: max(0, min(255, round(128 + 16 * (10 - distance(*at))))), "MET_UCHAR", "B")
volume("in/shorts.mha", (32, 32, 32), lambda *at: round(-1000 + 100 * (20 - distance(*at))), "MET_SHORT", "h",
       "ElementSpacing = 1 1 2\n")
P
isosculpt --replay "$strokes" --headless --output in/set.vdb --quiet
cp "$strokes" in/ball.strokes
for name in bytes.mha shorts.mha set.vdb ball.strokes; do
    case $name in bytes*) isovalue=128 ;; shorts*) isovalue=0 ;; *) isovalue=0 ;; esac
    isocompare report in/$name --isovalue $isovalue --side 64 --output "${name%.*}-$isovalue" --quiet
    for c in 1 0.8 0.6 0.4; do
        isorender in/$name "$name-$c.png" --isovalue $isovalue --primitive edge --method splats --groups 64 --group-overlap $c \
            --resolution 64x64 --json="$name-$c.json" --quiet
    done
done
python3 - <<'P'
from check import *
for name, folder, kind in (("bytes.mha", "bytes-128", "uint8"), ("shorts.mha", "shorts-0", "int16"), ("set.vdb", "set-0", "float32"),
                           ("ball.strokes", "ball-0", "float32")):
    j = report(folder + "/report.json")
    expect(j["volume"]["type"] == kind, name, j["volume"])
    points, = (row["primitives"] for row in j["extraction"] if row["part"] == "points")
    counts = {row["zoom"]: row for row in j["selection"]}
    expect(list(counts) == [1, 4, 16], name, counts)
    for row in counts.values():
        expect(row["points"] == points and 0 < row["seen"], name, row)
        expect(row["outside"] + row["hidden"] + row["same_pixel"] + row["seen"] == points, name, row)
    # all of a ball fits into the picture; (1 + sin 15 degrees) / 2 of it is hidden, less at its rim by the tolerance
    expect(counts[1]["outside"] == 0 and 0.5 * points < counts[1]["hidden"] < 0.63 * points, name, counts[1])
    expect(counts[16]["seen"] < counts[4]["seen"] < counts[1]["seen"], name, counts)
    rows = j["splats"]["rows"]
    expect([row["overlap"] for row in rows] == [1, 0.8, 0.6, 0.4] and j["splats"]["ungrouped_frame_seconds"] > 0, name, rows)
    for row in rows:
        drawn = report("%s-%g.json" % (name, row["overlap"]))
        groups = drawn["groups"][0]
        expect(row["groups"] == groups["count"], name, row, groups)
        expect(abs(row["mean_degree"] - 2 * groups["overlaps"] / drawn["primitives"]["points"]) < 1e-9, name, row, groups)
        expect(row["grouping_seconds"] > 0 and row["frame_seconds"] > 0, name, row)
    for row in j["transparency"]["rows"]:
        expect((row["median_seconds"] is None) == (row["compositing"] in ("average", "weighted")), name, row)
    expect({row["opacity"] for row in j["transparency"]["rows"]} == {0.3, 0.5, 0.7}, name)
    expect(("strokes" in j) == (name == "ball.strokes"), name)
    page = open(folder + "/report.html", encoding="utf-8").read()
    for title in ("Primitives", "Edits", "Viewports", "Selection of points", "Splats in groups") \
            + (("Strokes",) if "strokes" in j else ()):
        expect("<h3>%s</h3>" % title in page, name, title)
    expect("nan" not in page.split("<h2>What primitives cost</h2>")[1], name, "nan in the page")
P
