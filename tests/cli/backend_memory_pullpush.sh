# exit: 5
# stderr: isorender: scene:sphere:32: a picture of 2048x2048 needs *
# Buffers of discs count as well: what the cpu engine draws within the limit is too much for a software driver.
isorender --list-backends | grep '^egl surfaceless.*llvmpipe' >/dev/null || exit 77
isorender scene:sphere:32 in/cpu.png --method discs --resolution 2048x2048 --max-memory 250M --quiet
isorender scene:sphere:32 gl.png --backend egl --method discs --resolution 2048x2048 --max-memory 250M
