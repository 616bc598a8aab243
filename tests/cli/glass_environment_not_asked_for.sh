# exit: 2
# stderr: isorender: --environment is for glass: it needs --ior
isorender scene:sphere:16 a.png --environment in/none.exr
