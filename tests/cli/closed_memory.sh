# exit: 5
# stderr: isorender: in/zero.raw: grids of 4 MB for --closed or several surfaces' parts, beside the volume's 1 MB, are over the limit of 5 MB (--max-memory)
head -c 1000000 /dev/zero >in/zero.raw
isorender in/zero.raw --raw 100x100x100:uint8 zero.png --isovalue 1 --closed --max-memory 5M --resolution 20x20
