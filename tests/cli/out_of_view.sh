# exit: 6
# stderr: isorender: scene:torus:32: nothing of the surface is in view
isorender scene:torus:32 --camera-position 1000,0,0 --camera-focal-point 2000,0,0 --points p.ply --mesh m.ply
