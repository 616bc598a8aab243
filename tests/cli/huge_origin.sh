# exit: 3
# stderr: isorender: in/a.mha: its voxels lie up to 1e+300 mm from the origin*
python3 -c 'from check import *; ball("in/a.mha", header="Offset = 0 0 1e300\n")'
isorender in/a.mha out.png --isovalue 500
