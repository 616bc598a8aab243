# splats of a volume and of a file of points; their options, and options that are not for them
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha ball.png --isovalue 500 --method splats --reconstruction groups --json=ball.json --points ball.ply --quiet
isorender in/ball.mha one.png --isovalue 500 --method splats --reconstruction groups --threads 1 --points one.ply --quiet
isorender in/ball.mha pull.png --isovalue 500 --method pullpush --reconstruction gaussian --quiet
cmp ball.png one.png
isocompare images pull.png ball.png --fail-under psnr=28 >/dev/null
isorender ball.ply file.png --method splats --reconstruction groups --groups 64 --group-overlap 0.8 --group-bins 500 \
    --group-opposite --json=file.json --quiet
python3 - <<'P'
import json
ball, file = json.load(open('ball.json')), json.load(open('file.json'))
assert len(ball['groups']) == 1 and ball['groups'][0]['count'] == 8, ball['groups']
assert 8 < file['groups'][0]['count'] < 20 and file['groups'][0]['conflicts'] == 0, file['groups']
P
# overlapping discs of one plane may share a group (rule 1), which leaves fewer groups and nearly the same picture
for degrees in 0 20; do
    isorender ball.ply plane_$degrees.png --method splats --groups 64 --group-coplanar $degrees --json=plane_$degrees.json --quiet
done
isocompare images plane_0.png plane_20.png --fail-under psnr=30 >/dev/null
python3 - <<'P'
import json
many, few = (json.load(open('plane_%d.json' % degrees))['groups'][0]['count'] for degrees in (0, 20))
assert few < many, (few, many)
P
# flat discs, which are filtered, are the default, also of files of points; those of discs are not filtered
isorender in/ball.mha flat.png --isovalue 500 --method splats --json=flat.json --quiet
for how in flat onepass ewa; do
    isorender in/ball.mha $how.png --isovalue 500 --method splats --reconstruction $how --quiet
    isocompare images pull.png $how.png --fail-under psnr=26 >/dev/null
    isorender ball.ply file_$how.png --method splats --reconstruction $how --quiet
done
# the mean needs points in every pixel, and covers each that contains one, which widens outlines
isorender scene:sphere:128 dense.png --points dense.ply --resolution 64x64 --quiet
for how in flat mean; do
    isorender dense.ply small_$how.png --method splats --reconstruction $how --resolution 80x80 --quiet
done
isocompare images small_flat.png small_mean.png --fail-under psnr=15 >/dev/null
! cmp -s small_flat.png small_mean.png
isorender in/ball.mha usual.png --isovalue 500 --method splats --quiet
isocompare images flat.png usual.png --fail-under psnr=100 >/dev/null
isorender ball.ply usual.png --quiet
isorender ball.ply pull.png --method discs --quiet
isocompare images file_flat.png usual.png --fail-under psnr=100 >/dev/null
isocompare images file_flat.png pull.png --fail-under psnr=26 >/dev/null
python3 - <<'P'
import json
flat = json.load(open('flat.json'))
assert flat['method'] == 'splats' and 'groups' not in flat, flat
P
for how in sorted groups nearest; do
    isorender ball.ply $how.png --opacity 0.5 --transparency $how --resolution 400x400 --fit box --json=$how.json --background 000000 --quiet
    isorender in/ball.mha volume.png --isovalue 500 --method splats --opacity 0.5 --transparency $how --samples 4 --resolution 200x200 --quiet
done
isorender ball.ply usual.png --opacity 0.5 --resolution 400x400 --fit box --background 000000 --quiet
isocompare images sorted.png usual.png --fail-under psnr=100 >/dev/null
isocompare images sorted.png groups.png --fail-under psnr=30 >/dev/null
isocompare images sorted.png nearest.png --fail-under psnr=32 >/dev/null
isorender ball.ply root.png --opacity 0.5 --transparency groups --group-radii root --resolution 400x400 --fit box --json=root.json --background 000000 --quiet
isocompare images sorted.png root.png --fail-under psnr=30 >/dev/null
! cmp -s groups.png root.png
# copies of discs in other groups are better than larger discs
isorender ball.ply copies.png --opacity 0.5 --transparency groups --group-radii copies --resolution 400x400 --fit box --json=copies.json --background 000000 --quiet
isorender ball.ply copies_1.png --opacity 0.5 --transparency groups --group-radii copies --resolution 400x400 --fit box --background 000000 --quiet --threads 1
isocompare images copies.png copies_1.png --fail-under psnr=100 >/dev/null
for how in groups copies; do isocompare images sorted.png $how.png --json=to_$how.json >/dev/null; done
isorender_refuses 2 "group-radii copies" ball.ply --opacity 0.5 --transparency groups --group-radii copies --backend egl
python3 - <<'P'
import json
covering, root = json.load(open('groups.json'))['groups'][0], json.load(open('root.json'))['groups'][0]
copies, ratio = json.load(open('copies.json'))['groups'][0], [json.load(open('to_%s.json' % how)) for how in ('groups', 'copies')]
assert copies['copies'] > 0 and 'radius_factors' not in copies, copies
assert ratio[1]['metrics']['psnr_in'] > ratio[0]['metrics']['psnr_in'], ratio
assert all(1.05 < f < 1.6 for f in covering['radius_factors']) and 'radius_factors' not in root, (covering, root)
layers = json.load(open('sorted.json'))['image']['layers']
assert 1.9 < layers['mean'] < 2.1 and layers['most'] < 5, layers
P
for wrong in "--groups 4" "--reconstruction groups" "--method splats --groups 65" "--method splats --reconstruction box" "--reconstruction flat" "--method pullpush --reconstruction ewa" "--method discs --reconstruction gaussian" "--method discs --reconstruction onepass" \
    "--method splats --reconstruction flat --groups 4" "--method splats --reconstruction onepass --backend egl" \
    "--method splats --reconstruction mean --backend egl" "--method splats --reconstruction mean --opacity 0.5" \
    "--opacity 0.5 --transparency groups --reconstruction flat" "--method splats --opacity 0.5 --reconstruction ewa" \
    "--method exact --opacity 0.5 --backend egl" "--transparency groups" "--method exact --opacity 0.5 --transparency groups" \
    "--opacity 0.5 --transparency nearest --layers 1" "--method splats --opacity 0.5 --absorption 3" \
    "--method splats --opacity 0.5 --group-radii root" "--method exact --group-radii root"; do
    code=0
    isorender in/ball.mha wrong.png --isovalue 500 $wrong 2>message || code=$?
    [ $code = 2 ] || { echo "exit status $code for $wrong"; exit 1; }
    [ ! -e wrong.png ] || { echo "$wrong left a picture"; exit 1; }
done
