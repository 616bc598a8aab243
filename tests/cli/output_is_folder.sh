mkdir in/out.png
isorender scene:torus:32 in/out.png
