# exit: 3
# stderr: isorender: in/missing.vti: cannot read: No such file or directory
isorender in/missing.vti
