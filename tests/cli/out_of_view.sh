isorender scene:torus:32 --camera-position 1000,0,0 --camera-focal-point 2000,0,0 --points p.ply --mesh m.ply
