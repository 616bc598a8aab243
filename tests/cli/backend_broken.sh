# Whatever is wrong with a driver: status 4, one line that says it, no file; and auto does without.
mkdir in/none in/text in/other
echo text >in/text/libEGL.so.1
echo text >in/text/libOSMesa.so.8
other=$(ldd "$(command -v isorender)" | sed -n 's/.*libm\.so.* => \([^ ]*\).*/\1/p')
[ -z "$other" ] || ln -s "$other" in/other/libEGL.so.1
[ -z "$other" ] || ln -s "$other" in/other/libOSMesa.so.8

# refused BACKEND WORDS NAME=VALUE ...
refused() {
    backend=$1 words=$2
    shift 2
    status=0
    env "$@" isorender scene:sphere:32 out.png --backend "$backend" 2>err || status=$?
    grep '^isorender: ' err >said || true
    [ $status -eq 4 ] && [ "$(grep -c '' said)" -eq 1 ] && grep -q "$words" said && [ ! -e out.png ] ||
        { echo "$backend $*: status $status"; cat err; exit 1; }
    env "$@" isorender scene:sphere:32 auto.png --quiet
    rm auto.png
}

isorender --list-backends >list
if grep -q 'built without glad' list; then exit 77; fi
for backend in egl osmesa; do
    refused $backend 'in/none/lib.*cannot open' ISO_GL_LIBRARY_PATH="$PWD/in/none"
    refused $backend 'in/text/lib' ISO_GL_LIBRARY_PATH="$PWD/in/text"
    [ -z "$other" ] || refused $backend 'lacks\|older' ISO_GL_LIBRARY_PATH="$PWD/in/other"
    name=$backend
    [ $backend = osmesa ] || name='egl surfaceless'
    if grep "^$name.*Mesa" list | grep -qv 'cannot be used'; then
        refused $backend '4\.4 .*4\.5 is needed' MESA_GL_VERSION_OVERRIDE=4.4 MESA_GLSL_VERSION_OVERRIDE=440
    fi
done
if grep '^egl surfaceless.*Mesa' list | grep -qv 'cannot be used'; then
    refused egl 'egl surfaceless: ' MESA_GLSL_VERSION_OVERRIDE=440
    refused egl 'egl surfaceless: ' __EGL_VENDOR_LIBRARY_DIRS="$PWD/in/none" __EGL_VENDOR_LIBRARY_FILENAMES=
    refused egl 'EGL does not start\|no OpenGL context' LIBGL_DRIVERS_PATH="$PWD/in/none"
fi
