# exit: 2
# stderr: isorender: --method mesh draws no glass: exact, raycast and splats do
isorender scene:sphere:16 a.png --ior 1.5 --method mesh
