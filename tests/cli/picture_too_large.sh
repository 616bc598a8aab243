isorender scene:torus:32 --resolution 8000x8000 --max-memory 100M
