# exit: 7
# stderr: isosculpt: *no/such/a.ply*
isosculpt --replay $volumes/bear.strokes --headless --output no/such/a.ply
