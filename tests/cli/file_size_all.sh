# Files that may not grow beyond 1 kB: status 7, one line, nothing left, from every program and for every output.
isorender scene:sphere:32 in/a.png --resolution 300x300 --quiet
isorender scene:torus:32 in/b.png --resolution 300x300 --quiet
ls in >before
limited() {
    code=0
    (ulimit -f 1; exec "$@") >said 2>&1 || code=$?
    [ $code = 7 ] && [ "$(grep -c '' said)" = 1 ] && grep -q "cannot write: File too large\|cannot copy" said || { cat said; echo "$code: $*"; exit 1; }
    [ "$(ls | tr '\n' ' ')" = "before in said " ] && ls in | cmp - before || { ls . in; exit 1; }
}
limited isorender scene:sphere:32 out.png --quiet
limited isorender scene:sphere:32 --no-image --points p.ply --quiet
limited isorender scene:sphere:32 --no-image --mesh m.obj --quiet
limited isorender scene:sphere:32 --info --json=j.json
if ! isorender scene:sphere:32 --no-image --aov in/try.exr --quiet 2>&1 | grep -q "built without"; then
    rm in/try.exr
    limited isorender scene:sphere:32 --no-image --aov a.exr --quiet
fi
limited isocompare images in/a.png in/b.png --quiet --difference d.png --json=j.json
limited isocompare report scene:sphere:32 --side 64 --output report --quiet
limited isosculpt --headless --replay "$volumes/bear.strokes" --voxel-size 2 -o s.stl --quiet
