# exit: 2
# stderr: isosculpt: a.png: *
isosculpt --replay $volumes/bear.strokes --headless --output a.png
