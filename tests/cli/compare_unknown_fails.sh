isorender scene:torus:32 in/a.png --resolution 90x90 --quiet
isocompare images in/a.png in/a.png --quiet --fail-under wrong=50
