# exit: 7
# stderr: isorender: in/out.png: cannot write: Is a directory
mkdir in/out.png
isorender scene:torus:32 in/out.png
