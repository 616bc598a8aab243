# exit: 2
# stderr: isorender: 3 opacities for 2 isovalues
isorender scene:sphere:16 a.png --isovalue 0,1 --opacity 0.5,0.2,1
