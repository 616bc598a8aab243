# exit: 2
# stderr: isosculpt: standard input cannot be opened: *
isosculpt --headless --open - --output out.stl
