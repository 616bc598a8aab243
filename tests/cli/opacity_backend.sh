# exit: 2
# stderr: isorender: --backend egl draws translucent surfaces with --method splats only: others need the cpu
isorender scene:sphere:16 a.png --opacity 0.5 --backend egl
