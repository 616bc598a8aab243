# lines by pull-push: about as many samples as the exact shapes have (a ribbon's sharp bend differs); methods of
# surfaces are refused
python3 - <<'E'
open("in/zigzag.obj", "w").write("v -5 0 -3\nv 0 2 3\nv 5 0 -3\nl 1 2 3\n")
E
render() { # NAME OPTION..
    local name=$1
    shift
    isorender --lines in/zigzag.obj $name.png --samples 1 --camera-position 10,-35,30 --camera-focal-point 0,0,0 "$@" \
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
isorender --lines in/zigzag.obj --scene sphere both.png --samples 1 --method pullpush --resolution 128x128 --aov both.exr --json=both.json --quiet
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
# points or a hybrid surface, a mesh and ribbons in one pyramid: nearly the picture of each drawn alone
cat > in/plate.stl <<'E'
solid plate
facet normal 0 0 1
outer loop
vertex -60 -60 8
vertex 70 -50 12
vertex 0 70 3
endloop
endfacet
endsolid plate
E
printf 'v -70 -70 0\nv 70 -60 20\nv -60 70 40\nv 60 60 -60\nl 1 2\nl 3 4\nl 1 3\n' >in/around.obj
together() { # NAME OPTION..
    local name=$1
    shift
    isorender --scene sphere $name.png --samples 1 --surface in/plate.stl --lines in/around.obj --line-style ribbon --tube-radius 2 --fit box \
        --resolution 200x160 --json=$name.json --quiet "$@"
}
for method in pullpush hybrid; do
    together alone_$method --method $method
    together one_$method --method $method --one-pyramid --aov one.exr
    together two_threads --method $method --one-pyramid --threads 2
    cmp one_$method.png two_threads.png
done
python3 - <<'E'
import json
read = lambda name: json.load(open(name + ".json"))
for method in ("pullpush", "hybrid"):
    alone, one = read("alone_" + method), read("one_" + method)
    assert abs(alone["image"]["covered"] - one["image"]["covered"]) * 200 < alone["image"]["covered"], method
    wanted, got = (report["objects"][1]["samples"] for report in (alone, one))
    assert wanted > 50 and abs(wanted - got) * 10 <= wanted, (method, wanted, got)
E
for options in "--method discs" "--method exact" "" "--method splats --backend osmesa"; do
    code=0
    together none --one-pyramid $options 2>notes || code=$?
    [ $code -eq 2 ]
    grep -q "one-pyramid" notes
done
code=0
isorender --lines in/zigzag.obj none.png --method splats 2>notes || code=$?
[ $code -eq 2 ]
grep -q "method is for surfaces" notes
