# without a window, what was written is said in a line for each file, but not with --quiet
bear=$volumes/bear.strokes
isosculpt --replay "$bear" --headless --voxel-size 2 --output a.ply --mesh a.stl 2>said
grep -q "^isosculpt: $bear: wrote a.ply: [0-9]* points$" said && grep -q "^isosculpt: $bear: wrote a.stl: [0-9]* triangles$" said &&
    [ "$(wc -l <said)" -eq 2 ] || { cat said; exit 1; }
isosculpt --replay "$bear" --headless --voxel-size 2 --output a.ply --mesh a.stl --quiet 2>said
[ ! -s said ] || { cat said; exit 1; }
isosculpt --replay "$bear" --headless --voxel-size 2 --json=a.json 2>said
[ ! -s said ] || { cat said; exit 1; }
# nor is it silent that nothing was written
isosculpt --replay "$bear" --headless --voxel-size 4 2>said
grep -q "^isosculpt: $bear: note: nothing is written: --output or --mesh names a file$" said || { cat said; exit 1; }
