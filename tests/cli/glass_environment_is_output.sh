# exit: 2
# stderr: isorender: in/../in/sky.png: an output would overwrite the input in/sky.png
isorender scene:sphere:16 in/sky.png --resolution 20x10 --quiet
isorender scene:sphere:16 in/../in/sky.png --ior 1.5 --environment in/sky.png
