# exit: 7
# stderr: isorender: standard output: cannot write: No space left on device
isorender --help >/dev/full
