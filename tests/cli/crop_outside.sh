python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --crop 0,24,0,9,0,9
