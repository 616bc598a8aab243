# a brush that takes material away loses nothing beyond the grid, and says nothing; one that adds says that it does
cat >in/border.py <<'P'
from strokes import *
end = {"event": "end"}
for tool in ("carve", "blend-carve", "deflate", "smooth", "mask", "add", "blend-add", "inflate"):
    write("in/%s.strokes" % tool, [begin({"at": [62.0, 0, 0]}, tool=tool, radius=50.0), end])
P
python3 in/border.py
for tool in carve blend-carve deflate smooth mask; do
    isosculpt --replay in/$tool.strokes --headless --json=$tool.json 2>said
    [ ! -s said ] && grep -q '"clipped": false' $tool.json || { echo "$tool: $(cat said)"; exit 1; }
done
for tool in add blend-add inflate; do
    isosculpt --replay in/$tool.strokes --headless --json=$tool.json 2>said
    grep -q "beyond the grid: what lies outside is lost" said && grep -q '"clipped": true' $tool.json ||
        { echo "$tool: $(cat said)"; exit 1; }
done
