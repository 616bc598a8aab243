# exit: 7
# stderr: isocompare: standard output: cannot write: *
isorender scene:torus:32 in/a.png --resolution 40x40 --quiet
isocompare images in/a.png in/a.png >/dev/full
