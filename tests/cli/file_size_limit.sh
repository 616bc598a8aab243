ulimit -f 8
isorender scene:torus:32 out.png --quiet
