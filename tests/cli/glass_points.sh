# exit: 2
# stderr: isorender: in/points.ply: holds points, not a volume: --ior needs a volume
isorender scene:sphere:16 --no-image --points in/points.ply --quiet
isorender in/points.ply a.png --ior 1.5
