# exit: 6
# stderr: isorender: in/ball.mha: no part of the solid has 1e+06 mm3: the largest of 1 has 21[0-9][0-9]
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha ball.png --isovalue 500 --min-size 1e6
