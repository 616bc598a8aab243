# exit: 5
# stderr: isorender: in/sky.png: an environment of 2000x1000 needs 32 MB, limit is 21 MB (--max-memory)
isorender scene:sphere:16 in/sky.png --resolution 2000x1000 --quiet
isorender scene:sphere:16 a.png --ior 1.5 --environment in/sky.png --resolution 20x20 --max-memory 20M
