# lines by pull-push: about as many samples as the exact shapes have (a ribbon's sharp bend differs); methods of
# surfaces are refused
python3 - <<'E'
open("in/zigzag.obj", "w").write("v -5 0 -3\nv 0 2 3\nv 5 0 -3\nl 1 2 3\n")
E
render() { # NAME OPTION..
    local name=$1
    shift
    isorender --lines in/zigzag.obj $name.png --camera-position 10,-35,30 --camera-focal-point 0,0,0 "$@" \
        --resolution 256x192 --json=$name.json --quiet
}
for style in tube ribbon line; do
    render exact_$style --tube-radius 0.3 --line-style $style --method exact
    render drawn_$style --tube-radius 0.3 --line-style $style --method pullpush
done
render threads --tube-radius 0.3 --line-style tube --method pullpush --threads 2
cmp drawn_tube.png threads.png
# illuminated lines: other shading in the same samples; exact shapes have none
render lit --tube-radius 0.3 --method pullpush --line-shading illuminated
if cmp -s drawn_tube.png lit.png; then exit 1; fi
code=0
isorender --lines in/zigzag.obj none.png --line-shading illuminated 2>notes || code=$?
[ $code -eq 2 ]
grep -q "line-shading illuminated is for lines by pull-push" notes
isorender --lines in/zigzag.obj --scene sphere both.png --method pullpush --resolution 128x128 --aov both.exr --json=both.json --quiet
python3 - <<'E'
import json
read = lambda name: json.load(open(name + ".json"))["objects"][0]
for style in ("tube", "ribbon", "line"):
    exact, drawn = read("exact_" + style)["samples"], read("drawn_" + style)["samples"]
    assert abs(drawn - exact) <= (0.3 if style == "ribbon" else 0.15) * exact + 20, (style, exact, drawn)
    assert "widened_samples" not in read("drawn_" + style)
assert read("both")["samples"] > 0
assert read("lit")["samples"] == read("drawn_tube")["samples"]
E
code=0
isorender --lines in/zigzag.obj none.png --method splats 2>notes || code=$?
[ $code -eq 2 ]
grep -q "method is for surfaces" notes
