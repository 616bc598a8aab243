# exit: 7
# stderr: isorender: in/out.exr: cannot write: File too large
if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
# the picture fits, the numbers do not: both have to go, and what was there before stays
echo old >in/out.exr
trap '' XFSZ
ulimit -f 8
status=0
isorender scene:cube:64 out.png --resolution 200x200 --aov in/out.exr --quiet || status=$?
[ "$(cat in/out.exr)" = old ] || { echo "the old file is gone"; exit 1; }
[ "$(ls in)" = "$(printf 'out.exr\ntry.exr')" ] || { ls in; exit 1; }
exit $status
