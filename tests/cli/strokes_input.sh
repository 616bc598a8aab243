# A stroke file is an input like any other: the level set that its strokes make, as isosculpt writes it.
isosculpt --replay "$volumes/../tests/hostile/ball.strokes" --headless --output ball.vdb --quiet
isorender ball.vdb vdb.png --resolution 128x128 --json=vdb.json --quiet
isorender "$volumes/../tests/hostile/ball.strokes" strokes.png --resolution 128x128 --json=strokes.json --quiet
isorender - stdin.png --resolution 128x128 --json=stdin.json --quiet <"$volumes/../tests/hostile/ball.strokes"
isocompare report "$volumes/../tests/hostile/ball.strokes" --output made --side 64 --quiet
python3 - <<'P'
from check import *
vdb, strokes, stdin = (report(name + ".json") for name in ("vdb", "strokes", "stdin"))
expect(vdb["image"]["hash"] == strokes["image"]["hash"] == stdin["image"]["hash"], "the same picture")
expect(strokes["volume"]["format"] == "strokes" and strokes["volume"]["level_set"], strokes["volume"])
expect(strokes["volume"]["spacing"] == vdb["volume"]["spacing"], strokes["volume"])
cost = report("made/report.json")["strokes"]
expect(cost["strokes"] >= 1 and cost["samples"] >= cost["strokes"] and 1 <= cost["frames"] <= 50, cost)
expect([row["method"] for row in cost["rows"]] == ["points", "pullpush", "mesh", "exact"], cost)
expect(all(0 <= row["extraction_seconds"] < 60 and 0 < row["frame_seconds"] < 60 for row in cost["rows"]), cost)
expect("<h3>Strokes</h3>" in open("made/report.html", encoding="utf-8").read(), "a table of strokes")
P
head -c 100 "$volumes/../tests/hostile/ball.strokes" >cut.strokes
code=0
isorender cut.strokes cut.png 2>message || code=$?
[ "$code" = 3 ] && [ "$(wc -l <message)" = 1 ] && grep -q 'cut.strokes' message && [ ! -e cut.png ]
