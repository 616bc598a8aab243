head -c 1000000 /dev/zero >in/zero.raw
isorender in/zero.raw --raw 100x100x100:uint8 zero.png --isovalue 1 --closed --max-memory 5M --resolution 20x20
