# exit: 3
# stderr: isorender: standard input: is empty
isorender -
