isosculpt --replay $volumes/bear.strokes --headless --voxel-size 0.001
