# exit: 2
# stderr: isorender: option --opacity: '1.5' is not an opacity from 0 to 1
isorender scene:sphere:16 a.png --opacity 0.5,1.5
