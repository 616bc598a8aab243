# Drivers are found at run time: a machine without any runs the same program.
command -v ldd >/dev/null || exit 77
! ldd "$(command -v isorender)" | grep -E 'libGL|libEGL|libOSMesa|libGLX|libOpenGL|libX11'
ISO_GL_LIBRARY_PATH=$PWD isorender --list-backends >list
[ "$(grep -c 'cannot be used' list)" -ge 2 ]
