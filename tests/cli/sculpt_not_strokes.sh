isosculpt --replay $volumes/README.md --headless
