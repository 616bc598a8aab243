# exit: 7
# stderr: isorender: out.png: cannot write: File too large
ulimit -f 8
isorender scene:torus:32 out.png --quiet
