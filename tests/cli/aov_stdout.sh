isorender scene:torus:32 out.png --aov -
