# exit: 2
# stderr: isorender: in/../in/p.ply: an output would overwrite the input in/p.ply
isorender --quiet scene:sphere:32 --points in/p.ply --no-image
isorender in/p.ply --points in/../in/p.ply --no-image
