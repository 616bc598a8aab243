# exit: 5
# stderr: isosculpt: *memory*
# Lines whose distances do not fit into the memory that is allowed.
printf '1 1 0 0 0 1 -1\n2 1 100 0 0 1 1\n' >in/t.swc
isosculpt --quiet --headless --max-memory 16M --voxel-size 0.1 --open in/t.swc -o o.stl
