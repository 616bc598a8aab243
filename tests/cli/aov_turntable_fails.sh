# exit: 7
# stderr: isorender: in/t_001.exr: cannot write: Is a directory
if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
mkdir in/t_001.exr
status=0
isorender scene:torus:32 t.png --aov in/t.exr --turntable 3 --resolution 64x64 --quiet || status=$?
[ "$(ls -d in/t_*)" = in/t_001.exr ] || { ls in; exit 1; }
exit $status
