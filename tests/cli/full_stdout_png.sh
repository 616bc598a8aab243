# exit: 7
# stderr: isorender: *standard output: cannot write: *
isorender scene:torus:32 - --quiet >/dev/full
