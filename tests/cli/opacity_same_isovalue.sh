# exit: 2
# stderr: isorender: isovalue 1 is given twice
isorender scene:sphere:16 a.png --isovalue 1,1 --opacity 0.5
