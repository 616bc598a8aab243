# exit: 2
# stderr: isocompare: in/../in/a.png: an output would overwrite the input in/a.png
isorender scene:torus:32 in/a.png --resolution 40x40 --quiet
isocompare images in/a.png in/a.png --difference in/../in/a.png
