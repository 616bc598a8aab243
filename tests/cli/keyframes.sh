# Pictures between keyframes are those that isorender draws with the values in between.
python3 -c 'from check import *; ball("in/ball.mha"); ball("in/small.mha", radius=2.0)'
small="--resolution 60x50 --quiet"
place="--camera-position 60,11.5,11.5 --camera-focal-point 11.5,11.5,11.5"
cat >in/values.json <<'J'
{"keyframes": [
    {"frame": 0, "options": [{"isovalue": 300}, {"clip": "y<0"}]},
    {"frame": 2, "options": [{"opacity": 1}]},
    {"frame": 4, "options": [{"isovalue": "500"}, {"opacity": 0.5}, {"clip": "y<8"}, {"view-angle": 40}]}]}
J
isorender in/ball.mha v.png --keyframes in/values.json --view-angle 20 $place $small --samples 1 --json=all.json
[ "$(ls v_*.png | wc -l)" = 5 ]
one() { isorender in/ball.mha one.png $place $small --samples 1 --json=$1.json "${@:2}"; }
one 0 --isovalue 300 --clip 'y<0' --view-angle 20
one 1 --isovalue 350 --clip 'y<2' --view-angle 25
one 2 --isovalue 400 --clip 'y<4' --view-angle 30
one 3 --isovalue 450 --clip 'y<6' --opacity 0.75 --view-angle 35
one 4 --isovalue 500 --clip 'y<8' --opacity 0.5 --view-angle 40
python3 - <<'P'
from check import *
frames = report("all.json")["frames"]
for i in range(5):
    expect(frames[i]["hash"] == report("%d.json" % i)["image"]["hash"], i)
P
# the same from every method that draws from parts of the surface, and by any number of threads
for method in mesh points discs pullpush raycast; do
    sed 's/{"opacity": [0-9.]*}\(, \)*//; s/{"clip": "y<[08]"}, *//; s/, *{"clip": "y<[08]"}//' in/values.json >in/plain.json
    isorender in/ball.mha m.png --method $method --keyframes in/plain.json --view-angle 20 $place $small --samples 1 --json=all.json --threads 2
    one 3 --method $method --isovalue 450 --view-angle 35
    python3 -c 'from check import *; expect(report("all.json")["frames"][3]["hash"] == report("3.json")["image"]["hash"], "'$method'")'
done
# cameras turn by quaternions, at distances and along a way between those of the keyframes; a zoom is a factor
cat >in/cameras.json <<'J'
{"keyframes": [
    {"frame": 0, "options": [{"camera-position": "61.5,11.5,11.5"}, {"zoom": 1}]},
    {"frame": 3, "options": [{"camera-position": "11.5,211.5,11.5"}, {"zoom": 8}]},
    {"frame": 4, "options": [{"camera-focal-point": "0,0,0"}]}]}
J
isorender in/ball.mha c.png --isovalue 500 --keyframes in/cameras.json --camera-focal-point 11.5,11.5,11.5 $small --json=all.json
at=$(python3 -c 'import math; d = 50 * 4 ** (1 / 3); print("%.17g,%.17g,11.5" % (11.5 + d * math.cos(math.pi / 6), 11.5 + d * math.sin(math.pi / 6)))')
isorender in/ball.mha one.png --isovalue 500 --camera-position $at --camera-focal-point 11.5,11.5,11.5 --zoom 2 $small
isocompare images one.png c_001.png --quiet --fail-under psnr=70
isorender in/ball.mha one.png --isovalue 500 --camera-position 11.5,211.5,11.5 --camera-focal-point 11.5,11.5,11.5 --zoom 8 $small
isocompare images one.png c_003.png --quiet --fail-under psnr=70
# presets: half-way from the front to the right is an azimuth of -45 or 45 degrees
printf '{"keyframes": [{"frame": 0, "options": [{"camera": "front"}]}, {"frame": 2, "options": [{"camera": "left"}]}]}' >in/presets.json
printf '{"keyframes": [{"frame": 0, "options": [{"azimuth": 90}]}, {"frame": 2, "options": [{"azimuth": 0}]}]}' >in/turned.json
isorender scene:torus:32 p.png --up +y --keyframes in/presets.json $small
isorender scene:torus:32 a.png --up +y --keyframes in/turned.json $small
isocompare images a_001.png p_001.png --quiet --fail-under psnr=70
isocompare images a_000.png p_002.png --quiet --fail-under psnr=70
# one framing: fitted cameras are all as far away as the one that needs most
python3 -c 'from check import *; ball("in/long.mha", header="ElementSpacing = 1 4 1\n")'
isorender in/long.mha w.png --isovalue 500 --keyframes in/turned.json $small --json=w.json
for turn in 90 45 0; do isorender in/long.mha one.png --isovalue 500 --azimuth $turn --fit box $small --json; done >one.json
python3 - <<'P'
import json
from check import *
def distance(r): return sum((a - b) ** 2 for a, b in zip(r["camera"]["position"], r["camera"]["focal_point"])) ** 0.5
text, each = open("one.json").read(), []
while text.strip():
    value, end = json.JSONDecoder().raw_decode(text.lstrip())
    text = text.lstrip()[end:]
    each.append(distance(value))
expect(max(each) - min(each) > 1 and abs(distance(report("w.json")) - max(each)) < 1e-9, each)
P
# the box of the largest surface is framed; a whole turn by azimuth comes back
printf '{"interpolation": "smooth", "keyframes": [{"frame": 0, "options": [{"azimuth": 0}, {"isovalue": 900}]}, {"frame": 8, "options": [{"azimuth": 360}, {"isovalue": 300}]}]}' >in/turn.json
isorender in/ball.mha t.png --keyframes in/turn.json $small --orthographic --json=all.json
python3 - <<'P'
from check import *
counts = [f["covered"] for f in report("all.json")["frames"]]
expect(counts == sorted(counts), counts)
expect(counts[1] - counts[0] < counts[4] - counts[3], counts)
last = Png("t_008.png")
expect(all(row[0][:3] == (255, 255, 255) for row in last.rows), "out of the frame")
P
# frames may be empty, but not all of them
printf '{"keyframes": [{"frame": 0, "options": [{"isovalue": 900}]}, {"frame": 3, "options": [{"isovalue": 3000}]}]}' >in/gone.json
isorender in/ball.mha g.png --keyframes in/gone.json $small
printf '{"keyframes": [{"frame": 0, "options": [{"clip": "x<99"}]}, {"frame": 3, "options": [{"clip": "x<100"}]}]}' >in/all.json
isorender_refuses 6 "leaves nothing" in/ball.mha --isovalue 500 --keyframes in/all.json
# what is wrong is said with its place
wrong() { printf '%s' "$3" >in/wrong.json; isorender_refuses "$1" "$2" in/ball.mha --isovalue 500 --keyframes in/wrong.json; }
wrong 3 'wrong.json: line 1' '{"keyframes": ['
wrong 3 '2 to 10000 objects' '{"keyframes": [{"frame": 0}]}'
wrong 3 'above that of the keyframe before' '{"keyframes": [{"frame": 3}, {"frame": 3}]}'
wrong 2 'frame 3: method: it does not change in time; these do: azimuth' '{"keyframes": [{"frame": 0}, {"frame": 3, "options": [{"method": "mesh"}]}]}'
wrong 2 'frame 3: azimuth: .north' '{"keyframes": [{"frame": 0}, {"frame": 3, "options": [{"azimuth": "north"}]}]}'
wrong 2 'as many as surfaces' '{"keyframes": [{"frame": 0}, {"frame": 3, "options": [{"isovalue": "1,2"}]}]}'
wrong 3 '"linear" or "smooth"' '{"interpolation": "spline", "keyframes": [{"frame": 0}, {"frame": 3}]}'
isorender_refuses 2 "not --turntable" in/ball.mha --isovalue 500 --keyframes in/turn.json --turntable 3
isorender_refuses 2 "of a surface that stays" in/ball.mha --isovalue 500 --keyframes in/turn.json --closed
isorender_refuses 2 "cannot draw cuts (--clip) of what is translucent" in/ball.mha --isovalue 500 --keyframes in/values.json --method mesh
isorender_refuses 3 "nowhere.json" in/ball.mha --keyframes nowhere.json
# lines, glyphs and labels without an input are turned, too
printf 'x,y,z\n0,0,0\n3,0,0\n0,9,0\n' >in/atoms.csv
isorender --glyphs in/atoms.csv a.png --keyframes in/turned.json $small
[ "$(ls a_*.png | wc -l)" = 3 ]
isorender scene:organs:32 --smooth l.png --keyframes in/turned.json $small
[ "$(ls l_*.png | wc -l)" = 3 ]
wrong_input() { isorender_refuses 2 "of an input's surfaces change" --glyphs in/atoms.csv --keyframes in/faded.json; }
printf '{"keyframes": [{"frame": 0}, {"frame": 3, "options": [{"opacity": 0.5}]}]}' >in/faded.json
wrong_input
# with steps in time keyframes are for the steps
for t in 0 1 2 3 4; do cp in/ball.mha in/s_$t.mha; done
isorender --series-of 'in/s_*.mha' s.png --keyframes in/values.json --view-angle 20 $place $small --samples 1
for t in 0 1 2 3 4; do isocompare images s_00$t.png v_00$t.png --quiet --fail-under psnr=200; done
