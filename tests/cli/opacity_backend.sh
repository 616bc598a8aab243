# exit: 2
# stderr: isorender: --backend egl draws no translucent surfaces: --opacity below 1 needs the cpu
isorender scene:sphere:16 a.png --opacity 0.5 --backend egl
