# exit: 3
# stderr: isosculpt: *README.md* is not a stroke file*
isosculpt --replay $volumes/README.md --headless
