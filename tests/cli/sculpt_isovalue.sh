# exit: 2
# stderr: isosculpt: *stent.nrrd: needs --isovalue*
isosculpt --open $volumes/stent.nrrd --headless --output a.vdb
