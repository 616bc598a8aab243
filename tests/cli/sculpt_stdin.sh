isosculpt --headless --open - --output out.stl
