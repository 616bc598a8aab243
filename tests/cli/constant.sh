# exit: 6
# stderr: isorender: in/a.raw: *constant*
head -c 4096 /dev/zero >in/a.raw
isorender in/a.raw --raw 16x16x16:uint8 --quiet
