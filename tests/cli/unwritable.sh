# exit: 7
# stderr: isorender: in/missing/out.png: cannot write: No such file or directory
isorender scene:torus:32 in/missing/out.png
