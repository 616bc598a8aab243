isosculpt --open a.stl --headless --close-holes -1 --output o.vdb
