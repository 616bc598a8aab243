# exit: 6
# stderr: isorender: all opacities are 0: nothing would be seen
isorender scene:sphere:16 a.png --opacity 0
