# exit: 4
# stderr: isosculpt: *--headless*
isosculpt
