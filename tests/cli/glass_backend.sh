# exit: 2
# stderr: isorender: --backend egl draws no glass: --ior needs the cpu
isorender scene:sphere:16 a.png --ior 1.5 --backend egl
