# levels of detail of the points of a volume and of a file; when they are made without being asked for
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha all.png --isovalue 500 --method discs --resolution 6x6 --json=all.json --quiet
isorender in/ball.mha --isovalue 500 --points ball.ply --no-image --quiet
isorender in/ball.mha none.png --isovalue 500 --method discs --lod 0 --resolution 6x6 --json=none.json --quiet
isorender in/ball.mha lod.png --isovalue 500 --lod 1 --resolution 6x6 --json=lod.json --quiet
isorender in/ball.mha one.png --isovalue 500 --lod 1 --threads 1 --resolution 6x6 --quiet
isorender ball.ply file.png --lod 1 --resolution 6x6 --json=file.json --quiet
isorender in/ball.mha turn_{n:2}.png --isovalue 500 --method discs --turntable 50 --resolution 6x6 --json=turn.json --quiet
isorender in/ball.mha large_{n:2}.png --isovalue 500 --method discs --turntable 50 --resolution 90x90 --json=large.json --quiet
cmp lod.png one.png
isocompare images all.png lod.png --fail-under psnr=14 >/dev/null
python3 - <<'P'
import json
image = {name: json.load(open(name + '.json'))['image'] for name in ('all', 'none', 'lod', 'file', 'turn', 'large')}
points = {name: image[name].get('lod_points') for name in image}
assert image['all']['hash'] == image['none']['hash'] != image['lod']['hash'], image
assert points['all'] is None and points['none'] is None and points['large'] is None, points
for name in ('lod', 'file', 'turn'):
    assert points[name][0] == 0 and sum(points[name][1:]) > 0, points
chosen = {name: image[name]['selection'] for name in image}
assert chosen['all']['points'] > 3 * chosen['lod']['points'] > 0, chosen
for name in chosen:
    assert 0 < chosen[name]['drawn'] <= chosen[name]['tested'], chosen
assert json.load(open('lod.json'))['method'] == 'discs'
P
for wrong in "--lod -1" "--lod x" "--method exact --lod 1"; do
    code=0
    isorender in/ball.mha wrong.png --isovalue 500 $wrong 2>message || code=$?
    [ $code = 2 ] || { echo "exit status $code for $wrong"; exit 1; }
    [ ! -e wrong.png ] || { echo "$wrong left a picture"; exit 1; }
done
isorender --list-backends | grep '^egl surfaceless.*, ' >/dev/null || exit 0
for method in discs pullpush; do
    for engine in cpu egl; do
        isorender in/ball.mha $engine.png --isovalue 500 --method $method --lod 1 --resolution 12x12 --backend $engine \
            --json=$engine.json --quiet
    done
    isocompare images cpu.png egl.png --fail-under psnr=43 >/dev/null
    python3 - <<'P'
import json
cpu, gl = json.load(open('cpu.json')), json.load(open('egl.json'))
assert gl['backend'] == 'egl' and gl['image']['lod_points'] == cpu['image']['lod_points'], gl
P
done
