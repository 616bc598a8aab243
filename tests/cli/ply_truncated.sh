# exit: 3
# stderr: isorender: in/p.ply: *
isorender --quiet scene:sphere:32 --points in/p.ply --no-image
truncate -s -1 in/p.ply
isorender in/p.ply
