# edits of past strokes: what they give is what a file without them, or with them in place, gives; saved, and refused
cat > make.py <<'P'
import strokes as s

def stroke(x, **brush):
    at = {"at": [x, 0.0, 20.0]}
    return [s.begin(at, **brush), s.sample(at=[x, 8.0, 20.0]), {"event": "end"}]

a, b, c = stroke(-6.0, radius=6.0), stroke(0.0, tool="carve", radius=5.0), stroke(6.0, tool="smooth", radius=9.0, symmetry=1)
wide = stroke(0.0, tool="carve", radius=7.0)
s.write("abc.strokes", a + b + c)
s.write("ac.strokes", a + c)
s.write("wide.strokes", a + wide + c)
s.write("acb.strokes", a + c + b)
s.write("undone.strokes", a + b + c + [{"event": "mute", "stroke": 1, "last": 3}, {"event": "undo"}, {"event": "delete", "stroke": 2}])
s.write("before.strokes", a + c + [{**b[0], "before": 2}] + b[1:])
s.write("group.strokes", a + b + [{"event": "group", "stroke": 1, "last": 2, "group": "ears"}])
s.write("moved.strokes", a + [{**b[0], "at": [0.0, 3.0, 20.0]}] + [{**b[1], "at": [0.0, 9.0, 21.0]}] + b[2:] + c)
sample = [0.0, 3.0, 20.0, 0.0, 0.0, 1.0, 1.0, 0.1]
path = [sample, [0.0, 9.0, 21.0] + sample[3:]]
s.write("path.strokes", a + b + c + [{"event": "path", "stroke": 2, "path": path}])
s.write("reseated.strokes", a + b + c + [{"event": "reseat", "stroke": 2, "last": 2, "path": path}])
s.write("grouped.strokes", a + b + c + [{"event": "group", "stroke": 2, "group": "ears"}, {"event": "move", "group": "ears"}])
bad_paths = {"path-none": [], "path-short": [sample], "path-number": 3, "path-flat": sample, "path-seven": [sample[:7]] * 2,
             "path-text": [sample[:7] + ["1"], sample], "path-far": [[1e300] + sample[1:], sample], "path-null": None,
             "path-pressure": [sample, sample[:6] + [2.0, 0.0]], "path-long": path * 9}
for name, event in {**{name: {"event": "path", "stroke": 2, "path": value} for name, value in bad_paths.items()},
                    "path-range": {"event": "path", "stroke": 1, "last": 2, "path": path}, "path-missing": {"event": "path", "stroke": 2},
                    "path-group": {"event": "path", "group": "ears", "path": path}, "reseat-missing": {"event": "reseat", "stroke": 2, "last": 3},
                    "reseat-short": {"event": "reseat", "stroke": 1, "last": 3, "path": path},
                    "reseat-group": {"event": "reseat", "group": "ears", "path": path},
                    **{"repeat-%d" % i: {"event": "edit", "stroke": 1, "brush": s.brush(**members)} for i, members in enumerate([
                        {"repeat": [3, 0]}, {"repeat_by": [[1.0] * 3] * 2}, {"repeat": 3, "repeat_by": [1.0] * 3}, {"repeat": [3, 0], "repeat_by": [[0.0] * 3] * 2},
                        {"repeat": [3, 1 << 40], "repeat_by": [[1.0] * 3] * 2}, {"repeat": [-3, 1], "repeat_by": [[1.0] * 3] * 2},
                        {"repeat": [3, 1], "repeat_by": [[1e300] * 3] * 2}, {"repeat": [256, 256], "repeat_by": [[1.0] * 3] * 2},
                        {"repeat": [3, "1"], "repeat_by": [[1.0] * 3] * 2}, {"repeat": [3, 1], "repeat_by": [[1.0] * 3]}])},
                    "group-none": {"event": "mute", "group": "ears"}, "group-empty": {"event": "mute", "group": ""},
                    "group-number": {"event": "delete", "group": 7}, "group-edit": {"event": "edit", "group": "ears", "brush": s.brush()},
                    "group-group": {"event": "group", "group": "ears"}, "group-long": {"event": "mute", "group": "x" * 1024},
                    "none": {"event": "mute", "stroke": 9}, "zero": {"event": "delete", "stroke": 0},
                    "backwards": {"event": "mute", "stroke": 3, "last": 1}, "huge": {"event": "unmute", "stroke": 1, "last": 1 << 60},
                    "itself": {"event": "move", "stroke": 1, "last": 2, "before": 2}, "brush": {"event": "edit", "stroke": 1},
                    "radius": {"event": "edit", "stroke": 1, "brush": s.brush(radius=-1.0)},
                    "radial": {"event": "edit", "stroke": 1, "brush": s.brush(radial=33, radial_axis="z")},
                    "axis": {"event": "edit", "stroke": 1, "brush": s.brush(radial=6, radial_axis="w")}, "text": {"event": "move", "stroke": "1"},
                    "nameless": {"event": "group", "stroke": 1}, "drawing": None}.items():
    s.write(name + ".bad", a + b + c + ([event] if event else a[:2] + [{"event": "mute", "stroke": 1}]))
P
python3 make.py
play() { isosculpt --replay "$1.strokes" --headless --output "$2.ply" --quiet "${@:3}"; }
for name in abc ac wide acb undone before; do play $name $name; done
cmp abc.ply before.ply
cmp ac.ply undone.ply
play abc deleted --delete 2 --save-strokes deleted.strokes
cmp deleted.ply ac.ply
play deleted again
cmp again.ply ac.ply
play abc muted --mute 1-3 --unmute 1 --unmute 3
cmp muted.ply ac.ply
play abc edited --edit 2:radius=7 --threads 1 --json=edited.json
cmp edited.ply wide.ply
play abc moved --move 2:end
cmp moved.ply acb.ply
play acb back --move 3:2
cmp back.ply abc.ply
# another path, and groups
for name in moved path reseated grouped; do play $name $name; done
cmp moved.ply path.ply
cmp moved.ply reseated.ply
cmp grouped.ply acb.ply
play abc named --group 2:ears --move ears:end --save-strokes named.strokes
cmp named.ply acb.ply
grep -q '"event":"move","group":"ears","crc"' named.strokes
play named named2 --unmute ears --edit ears:radius=7 --move ears:3
cmp named2.ply wide.ply
play abc none --mute 1 --group 2:a:b --group 3:a:b --delete a:b --unmute 1-3 --json=none.json
grep -q '"stroke_list": \[' none.json && ! grep -q '"stroke": 2' none.json
# reseated strokes follow the surface, headless as in the file that this writes; what has not moved stays
play abc reseat --edit 1:radius=3 --reseat 2-3 --save-strokes reseat.strokes
play reseat reseat2
cmp reseat.ply reseat2.ply
grep -q '"event":"reseat","stroke":2,"last":3,"path":\[\[' reseat.strokes
play abc floating --edit 1:radius=3
! cmp -s reseat.ply floating.ply
play abc still --reseat 1-3
cmp still.ply abc.ply
for wrong in "--reseat ears" "--mute ears" "--edit ears:radius=2" "--reseat 7-9" "--reseat 1:2"; do
    code=0
    isosculpt --replay abc.strokes --headless --quiet $wrong --output wrong.ply 2>message || code=$?
    [ "$code" != 0 ] && [ "$(wc -l <message)" = 1 ] && [ ! -e wrong.ply ] || { echo "$wrong: $code"; cat message; exit 1; }
done
# radial symmetry: given afterwards, it is that of a file that has it
python3 - <<'P'
import strokes as s
stroke = lambda **brush: [s.begin({"at": [12.0, 2.0, 19.0]}, **brush), {"event": "end"}]
s.write("plain.strokes", stroke(radius=5.0))
s.write("radial.strokes", stroke(radius=5.0, radial=6, radial_axis="y", symmetry=2))
s.write("two.strokes", stroke(radius=5.0, radial=2, radial_axis="z"))
s.write("repeat.strokes", stroke(radius=4.0, repeat=[3, 2], repeat_by=[[-12.0, 0.0, 0.0], [0.0, -9.5, 1.0]]))
P
play radial radial
play plain given --edit 1:radial=6y,symmetry=y --save-strokes given.strokes
cmp given.ply radial.ply
grep -q '"radial":6,"radial_axis":"y"' given.strokes
play given taken --edit 1:radial=none,symmetry=none
play plain plain
cmp taken.ply plain.ply
play two turned
play plain turned2 --edit 1:radial=2
cmp turned.ply turned2.ply
play plain moved2 --edit 1:radial=2,mirror=5/0/0
! cmp -s turned.ply moved2.ply
play repeat repeat
play plain repeated --edit 1:radius=4,repeat=3x-12/0/0+2x0/-9.5/1 --save-strokes repeated.strokes
cmp repeat.ply repeated.ply
grep -q '"repeat":\[3,2\],"repeat_by":\[\[-12.0,0.0,0.0\],\[0.0,-9.5,1.0\]\]' repeated.strokes
play repeated repeated2
cmp repeated.ply repeated2.ply
play repeat single --edit 1:radius=5,repeat=none
cmp single.ply plain.ply
for wrong in 3 3x1/2 3x1/2/3x 3x1/2/3+ 3x1/2/3+4x 257x1/0/0 -2x1/0/0 3x0/0/0 3x1/0/0+2x0/0/0+2x1/1/1 20x1/0/0+20x0/1/0 2xnan/0/0; do
    code=0
    isosculpt --replay plain.strokes --headless --quiet --edit "1:repeat=$wrong" --output wrong.ply 2>message || code=$?
    [ "$code" = 2 ] && [ "$(wc -l <message)" = 1 ] && [ ! -e wrong.ply ] || { echo "repeat=$wrong: $code"; cat message; exit 1; }
done
play abc both --edit 1-3:radius=4,strength=.5,symmetry=xz --group 1-2:ears --save-strokes both.strokes
play both both2 --json=both.json
cmp both.ply both2.ply
head -1 both.strokes | grep -q '"version":3,'
head -1 abc.strokes | grep -q '"version":1,'
# strokes that are saved without edits are the file itself
isosculpt --replay "$volumes/bear.strokes" --headless --save-strokes same.strokes --quiet
cmp same.strokes "$volumes/bear.strokes"
isosculpt --replay "$volumes/bear.strokes" --headless --edit 12:radius=4 --mute 20-24 --json=bear.json --quiet
python3 - <<'P'
from check import *
edited, both, bear = report("edited.json"), report("both.json"), report("bear.json")
expect([s["stroke"] for s in edited["stroke_list"]] == [1, 2, 3], edited["stroke_list"])
expect(edited["stroke_list"][1]["radius"] == 7 and edited["strokes_drawn_again"] >= 3, edited)
expect([s.get("group") for s in both["stroke_list"]] == ["ears", "ears", None], both["stroke_list"])
expect(bear["seconds"]["stroke_edit"]["count"] == 2 and bear["version_bytes"] > 0, bear["seconds"])
expect([s["stroke"] for s in bear["stroke_list"] if s["muted"]] == [20, 21, 22, 23, 24], bear["stroke_list"])
P
# hostile lines are refused in one line that names theirs, and nothing is written
for bad in *.bad; do
    cp "$bad" bad.strokes
    code=0
    isosculpt --replay bad.strokes --headless --output bad.ply --quiet 2>message || code=$?
    [ "$code" = 3 ] && [ "$(wc -l <message)" = 1 ] && grep -q "bad.strokes' line 1[0-9]: " message && [ ! -e bad.ply ] ||
        { echo "$bad: $code"; cat message; exit 1; }
done
