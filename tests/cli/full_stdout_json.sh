# exit: 7
# stderr: isorender: *standard output: cannot write: *
isorender scene:torus:32 --no-image --json --quiet >/dev/full
