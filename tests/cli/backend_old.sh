# exit: 4
# stderr: isorender: egl *3.3*4.5 is needed
isorender --list-backends | grep '^egl surfaceless.*Mesa' | grep -qv 'cannot be used' || exit 77
python3 -c 'from check import *; ball("in/ball.mha")'
MESA_GL_VERSION_OVERRIDE=3.3 isorender --backend egl in/ball.mha out.png --isovalue 500
