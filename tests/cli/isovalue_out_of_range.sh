python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 5000 --points p.ply
