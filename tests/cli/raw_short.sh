# exit: 3
# stderr: isorender: in/a.raw: *
head -c 4095 /dev/zero >in/a.raw
isorender in/a.raw --raw 16x16x16:uint8
