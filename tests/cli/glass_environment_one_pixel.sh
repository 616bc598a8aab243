# exit: 3
# stderr: isorender: in/one.png: 1x1 pixels are no environment: an equirectangular picture is wanted*
isorender scene:sphere:16 in/one.png --resolution 1x1 --quiet
isorender scene:sphere:16 a.png --ior 1.5 --environment in/one.png
