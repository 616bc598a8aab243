isocompare report nowhere.nrrd --output made
