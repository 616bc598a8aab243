isosculpt --replay in/no.strokes --headless
