# exit: 6
# stderr: isorender: in/a.raw: no surface at isovalue 3: every voxel is 0
head -c 4096 /dev/zero >in/a.raw
isorender in/a.raw --raw 16x16x16:uint8 --isovalue 3
