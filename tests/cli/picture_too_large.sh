# exit: 5
# stderr: isorender: scene:torus:32: a picture of 8000x8000 with 4 samples a pixel needs *--samples 1*
isorender scene:torus:32 --resolution 8000x8000 --max-memory 100M
