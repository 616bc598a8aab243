# exit: 2
# stderr: isorender: in/a.raw: option --raw: raw layout '16x16x16:int64': the type must be *
head -c 4096 /dev/zero >in/a.raw
isorender in/a.raw --raw 16x16x16:int64
