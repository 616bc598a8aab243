# exit: 5
# stderr: isorender: scene:sphere:16: a picture of 8000x8000 needs *
isorender scene:sphere:16 a.png --ior 1.5 --refraction two-sided --resolution 8000x8000 --max-memory 1G
