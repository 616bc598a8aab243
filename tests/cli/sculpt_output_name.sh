isosculpt --replay $volumes/bear.strokes --headless --output a.png
