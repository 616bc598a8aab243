# A link stays a link and its target is replaced; a file that nobody may write to stays as it is, also for root.
mkdir in/far
echo old >in/far/picture.png
ln -s far/picture.png in/link.png
ln -s link.png in/link2.png
isorender scene:sphere:16 in/link2.png --resolution 32x32 --quiet
[ -L in/link2.png ] && [ -L in/link.png ] && [ "$(head -c 4 in/far/picture.png | tail -c 3)" = PNG ]
kept() {
    local code=0
    "$@" 2>said >/dev/null || code=$?
    [ $code = 7 ] && [ "$(grep -c '' said)" = 1 ] && grep -q "in/kept.*cannot write: Permission denied" said || { cat said; echo "status $code: $*"; exit 1; }
    [ "$(cat in/kept)" = precious ] && [ ! -e other.ply ] && [ ! -e other.stl ] || { ls; exit 1; }
}
echo precious >in/kept
chmod 444 in/kept
ln -s kept in/kept.png
ln -s kept in/kept.stl
kept isorender scene:sphere:16 in/kept.png --points other.ply --quiet
kept isorender scene:sphere:16 --no-image --mesh in/kept.stl --points other.ply --quiet
kept isorender scene:sphere:16 --no-image --points other.ply --json=in/kept --quiet
kept isosculpt --headless --replay "$volumes/bear.strokes" --voxel-size 4 -o other.stl --json=in/kept --quiet
kept isosculpt --headless --replay "$volumes/bear.strokes" --voxel-size 4 -o in/kept.stl --mesh other.stl --quiet
isorender scene:sphere:16 in/a.png --resolution 32x32 --quiet
kept isocompare images in/a.png in/a.png --json=in/kept --quiet
# What cannot be written later takes away what was written before: the mesh fits, its report does not.
code=0
isosculpt --headless --replay "$volumes/bear.strokes" --voxel-size 4 -o other.stl --json=/dev/full --quiet 2>said || code=$?
[ $code = 7 ] && [ ! -e other.stl ] && [ -c /dev/full ] || { cat said; ls; exit 1; }
code=0
ln -s /dev/null in/null.ply
isorender scene:sphere:16 --no-image --points in/null.ply --json=/dev/full --quiet 2>said || code=$?
[ $code = 7 ] && [ -c /dev/null ] || { cat said; exit 1; }
