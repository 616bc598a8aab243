# exit: 3
# stderr: isorender: in/none.exr: *
isorender scene:sphere:16 a.png --ior 1.5 --environment in/none.exr
