# exit: 2
# stderr: isorender: no input (see --help)
isorender
