# exit: 2
# stderr: isorender: --method mesh draws no translucent surfaces: exact and raycast do
isorender scene:sphere:16 a.png --opacity 0.5 --method mesh
