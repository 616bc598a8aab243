# exit: 2
# stderr: isorender: --method mesh draws no translucent surfaces: exact, raycast and splats do
isorender scene:sphere:16 a.png --opacity 0.5 --method mesh
