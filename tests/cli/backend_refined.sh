python3 -c 'from check import *; ball("in/ball.mha")'
isorender --backend egl --method pullpush --reconstruction refined in/ball.mha out.png --isovalue 500
