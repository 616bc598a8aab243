python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha ball.png --isovalue 500 --min-size 1e6
