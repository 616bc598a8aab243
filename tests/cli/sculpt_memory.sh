# exit: 5
# stderr: isosculpt: out of memory: *, limit is 10 MB (--max-memory)
isosculpt --replay "$volumes/bear.strokes" --headless --voxel-size 0.3 --output bear.stl --quiet --max-memory 10M
