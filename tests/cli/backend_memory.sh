# exit: 5
# stderr: isorender: scene:sphere:32: a picture of 4096x4096 needs *
# Software drivers draw in main memory, which counts.
isorender --list-backends | grep '^egl surfaceless.*llvmpipe' >/dev/null || exit 77
isorender scene:sphere:32 in/cpu.png --method points --resolution 4096x4096 --max-memory 500M --quiet
isorender scene:sphere:32 gl.png --backend egl --resolution 4096x4096 --max-memory 500M
