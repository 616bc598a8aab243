# exit: 3
# stderr: isosculpt: *in/no.strokes*
isosculpt --replay in/no.strokes --headless
