isosculpt --replay $volumes/bear.strokes --headless --output no/such/a.ply
