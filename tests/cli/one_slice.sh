# exit: 6
# stderr: isorender: in/a.mha: 8 x 8 x 1 voxels have no surface: *
python3 -c 'from check import *; volume("in/a.mha", (8, 8, 1), lambda x, y, z: 10.0 * x)'
isorender in/a.mha out.png --isovalue 35
