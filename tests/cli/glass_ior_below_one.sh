# exit: 2
# stderr: isorender: option --ior: 0.9 is not in 1 .. 10
isorender scene:sphere:16 a.png --ior 0.9
