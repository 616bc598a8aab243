# exit: 2
# stderr: isosculpt: *stent.nrrd: holds no level set, and needs --isovalue*
isosculpt --open $volumes/stent.nrrd --headless --output a.vdb
