# exit: 3
# stderr: isocompare: nowhere.nrrd: *
isocompare report nowhere.nrrd --output made
