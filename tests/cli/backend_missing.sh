# exit: 4
# stderr: isorender: @(*libEGL.so.1*|*built without glad*)
python3 -c 'from check import *; ball("in/ball.mha")'
ISO_GL_LIBRARY_PATH=$PWD/in isorender --backend egl in/ball.mha out.png --isovalue 500
