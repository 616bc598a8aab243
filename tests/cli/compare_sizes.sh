# exit: 1
# stderr: isocompare: *sizes differ: 90x90 and 90x91
isorender scene:torus:32 in/a.png --resolution 90x90 --quiet
isorender scene:torus:32 in/b.png --resolution 90x91 --quiet
isocompare images in/a.png in/b.png
