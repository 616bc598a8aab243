isorender scene:torus:32 out.png --quiet --progress --verbose=quiet --resolution 32x32 2>log
[ ! -s log ]
