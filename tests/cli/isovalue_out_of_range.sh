# exit: 6
# stderr: isorender: in/ball.mha: no surface at isovalue 5000: values lie in 0 .. 9*
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 5000 --points p.ply
