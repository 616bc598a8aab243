# exit: 7
# stderr: isorender: in/missing/out.png: cannot write: its folder does not exist
isorender scene:torus:32 in/missing/out.png
