isorender --quiet scene:sphere:32 --points in/p.ply --no-image
isorender in/p.ply --points in/../in/p.ply --no-image
