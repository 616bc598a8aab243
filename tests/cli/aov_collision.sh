# exit: 2
# stderr: isorender: x.exr: two outputs have this name
if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
isorender in/a.vti in/b.vti --output "{model}.png" --aov x.exr
