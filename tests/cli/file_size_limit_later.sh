# exit: 7
# stderr: isorender: m.obj: cannot write: File too large
# the points fit, the mesh does not: both have to go
ulimit -f 70
isorender scene:cube:16 out.png --points p.ply --mesh m.obj --quiet
