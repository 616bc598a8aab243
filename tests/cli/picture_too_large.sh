# exit: 5
# stderr: isorender: scene:torus:32: a picture of 8000x8000 needs *
isorender scene:torus:32 --resolution 8000x8000 --max-memory 100M
