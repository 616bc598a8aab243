# exit: 2
# stderr: isorender: --attenuation-color and --attenuation-distance need each other
isorender scene:sphere:16 a.png --ior 1.5 --attenuation-color red
