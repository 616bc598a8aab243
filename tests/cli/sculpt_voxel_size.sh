# exit: 5
# stderr: isosculpt: voxels of 0.001 mm: *
isosculpt --replay $volumes/bear.strokes --headless --voxel-size 0.001
