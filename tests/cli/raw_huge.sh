# exit: 5
# stderr: isorender: in/a.raw: *
head -c 4096 /dev/zero >in/a.raw
isorender in/a.raw --raw 1000000x1000000x1000000:uint8
