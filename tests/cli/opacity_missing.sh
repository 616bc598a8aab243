# exit: 2
# stderr: isorender: --absorption is for translucent surfaces: it needs an opacity below 1
isorender scene:sphere:16 a.png --absorption 3
