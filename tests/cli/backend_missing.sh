python3 -c 'from check import *; ball("in/ball.mha")'
ISO_GL_LIBRARY_PATH=$PWD/in isorender --backend egl in/ball.mha out.png --isovalue 500
