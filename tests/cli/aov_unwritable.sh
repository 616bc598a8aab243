# exit: 7
# stderr: isorender: in/missing/out.exr: cannot write: its folder does not exist
if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
isorender scene:torus:32 out.png --aov in/missing/out.exr
