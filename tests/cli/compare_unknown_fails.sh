# exit: 1
# stderr: isocompare: in/a.png: wrong is *nan, not at most 50
isorender scene:torus:32 in/a.png --resolution 90x90 --quiet
isocompare images in/a.png in/a.png --quiet --fail-under wrong=50
