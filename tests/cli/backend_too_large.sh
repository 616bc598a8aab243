# exit: 5
# stderr: isorender: 16384x16384 with 64 samples a pixel*--backend cpu*
python3 -c 'from check import *; ball("in/ball.mha")'
isorender --backend egl in/ball.mha out.png --isovalue 500 --resolution 16384x16384 --samples 64
