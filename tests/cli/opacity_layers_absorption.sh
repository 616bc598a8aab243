# exit: 2
# stderr: isorender: --layers leaves out where rays leave the solid, which --absorption must know
isorender scene:sphere:16 a.png --opacity 0.5 --layers 1 --absorption 3
