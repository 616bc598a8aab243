# exit: 5
# stderr: isorender: in/a.mha: *
printf 'ObjectType = Image\nNDims = 3\nDimSize = 1000000 1000000 1000000\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n' >in/a.mha
head -c 4096 /dev/zero >>in/a.mha
isorender in/a.mha
