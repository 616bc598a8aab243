# exit: 3
# stderr: isorender: in/a.vti: the file is empty
: >in/a.vti
isorender in/a.vti
