# exit: 2
# stderr: isorender: option --aov: x.exr: 2 inputs need an output each: a template, such as '{model}.exr'
if isorender scene:sphere:16 --no-image --aov in/try.exr 2>&1 | grep -q "built without"; then echo "skipped: built without OpenEXR"; exit 77; fi
isorender in/a.vti in/b.vti --output "{model}.png" --aov x.exr
