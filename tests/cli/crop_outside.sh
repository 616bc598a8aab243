# exit: 2
# stderr: isorender: in/ball.mha: --crop reaches outside: there are 24 x 24 x 24 voxels
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --crop 0,24,0,9,0,9
