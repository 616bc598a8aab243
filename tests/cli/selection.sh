# the points that nearer ones hide: drawn or left out, the picture is the same; refused where nothing is selected
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500 --points ball.ply --no-image --quiet
for method in "discs" "discs --reconstruction flat" "splats" "splats --reconstruction onepass" "splats --reconstruction ewa"; do
    for which in auto visible all; do
        isorender --scene gyroid:128 $which.png --method $method --selection $which --resolution 300x300 \
            --json=$which.json --quiet
    done
    python3 - <<'P'
import json
hashes = [json.load(open(name + '.json'))['image']['hash'] for name in ('auto', 'visible', 'all')]
assert hashes[0] == hashes[1] == hashes[2], hashes
counts = {name: json.load(open(name + '.json'))['image']['selection'] for name in ('auto', 'visible', 'all')}
assert counts['auto'] == counts['visible'], counts
assert counts['visible']['points'] == counts['all']['points'], counts
assert counts['visible']['tested'] < counts['all']['tested'], counts
assert counts['visible']['drawn'] * 1.2 < counts['all']['drawn'], counts
P
done
# without a method: splats
isorender ball.ply file.png --selection all --resolution 40x40 --json=file.json --quiet
python3 -c "import json; assert json.load(open('file.json'))['method'] == 'splats'"
# by OpenGL: small discs are chosen by cells of pixels, larger ones by blocks alone, which changes no byte
for backend in egl osmesa; do
    isorender --list-backends | grep "^$backend" | grep -qv 'cannot be used' || { echo "no $backend here"; continue; }
    for size in 60x60 300x300; do
        for which in visible all; do
            isorender --scene gyroid:96 ${which}_{n}.png --method splats --selection $which --resolution $size \
                --turntable 2 --backend $backend --json=$which.json --quiet
        done
        isocompare images all_1.png visible_1.png --fail-under psnr=40 >/dev/null
        SIZE=$size python3 - <<'P'
import json
import os
frames, all_points = (json.load(open(name + '.json'))['frames'] for name in ('visible', 'all'))
for frame, other in zip(frames, all_points):
    counts = frame['selection']
    assert 'selection' not in other and 0 < counts['drawn'] <= counts['tested'] <= counts['points'], frame
    if os.environ['SIZE'] == '60x60':
        assert counts['drawn'] * 4 < counts['points'], frame
    else:
        assert frame['hash'] == other['hash'], (frame, other)
P
    done
done
# by itself, OpenGL leaves out what is hidden where that saves time, to the same bytes: of many points, not of few
for backend in egl osmesa; do
    isorender --list-backends | grep "^$backend" | grep -qv 'cannot be used' || continue
    for of in "discs 96 300x300" "splats 160 200x200" "discs 16 600x600"; do
        set -- $of
        for which in auto all; do
            isorender --scene gyroid:$2 ${which}_{n}.png --method $1 --selection $which --resolution $3 \
                --turntable 3 --backend $backend --json=$which.json --quiet
        done
        SIZE=$2 python3 - <<'P'
import json
import os
frames, all_points = (json.load(open(name + '.json'))['frames'] for name in ('auto', 'all'))
for frame, other in zip(frames, all_points):
    assert frame['hash'] == other['hash'], (frame, other)
    assert 'selection' not in other, other
    if os.environ['SIZE'] == '16':
        assert 'selection' not in frame, frame
    else:
        assert frame['selection']['drawn'] * 1.3 < frame['selection']['points'], frame
P
    done
done
for wrong in "--selection some" "--method exact --selection all" \
    "--method splats --reconstruction groups --selection all" "--method pullpush --selection visible" \
    "--method splats --opacity 0.5 --selection all"; do
    code=0
    isorender in/ball.mha wrong.png --isovalue 500 $wrong 2>message || code=$?
    [ $code = 2 ] || { echo "exit status $code for $wrong"; exit 1; }
    [ ! -e wrong.png ] || { echo "$wrong left a picture"; exit 1; }
done
