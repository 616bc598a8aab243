# exit: 2
# stderr: isorender: in/a.swc: *
printf "1 1 0 0 0 1 -1\n2 1 5 0 0 1 1\n" >in/a.swc
isorender --lines in/a.swc b.png --json=in/a.swc
