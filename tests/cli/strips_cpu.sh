# exit: 2
# stderr: isorender: --strips is for --method mesh with OpenGL*
isorender scene:sphere:32 out.png --strips --method mesh --backend cpu
