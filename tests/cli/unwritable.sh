isorender scene:torus:32 in/missing/out.png
