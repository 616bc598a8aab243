# exit: 2
# stderr: isorender: the picture and --json cannot both go to standard output
isorender x.vti - --json
