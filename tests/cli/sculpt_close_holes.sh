# exit: 2
# stderr: isosculpt: option --close-holes: '-1' is no size in mm*
isosculpt --open a.stl --headless --close-holes -1 --output o.vdb
