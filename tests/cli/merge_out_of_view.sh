# exit: 6
# stderr: isorender: nothing of the surface is in view
isorender scene:ct:48 --part 1/1 -o in/1.isokeys --quiet --camera-position 900,0,0 --camera-focal-point 999,0,0
isorender merge in/1.isokeys -o a.png
