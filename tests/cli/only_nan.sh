# exit: 6
# stderr: isorender: in/a.raw: *
head -c 16384 /dev/zero | tr '\0' '\377' >in/a.raw
isorender in/a.raw --raw 16x16x16:float --quiet
