# exit: 2
# stderr: isorender: --mesh writes no opacities: --opacity is for pictures
isorender scene:sphere:16 a.png --opacity 0.5 --mesh a.stl
