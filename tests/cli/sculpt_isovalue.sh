isosculpt --open $volumes/stent.nrrd --headless --output a.vdb
