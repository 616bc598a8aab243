# exit: 2
# stderr: isorender: --refraction is for glass: it needs --ior
isorender scene:sphere:16 a.png --refraction none
