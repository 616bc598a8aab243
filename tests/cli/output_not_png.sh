# exit: 2
# stderr: isorender: b.jpg: a picture's name must end in .png*
isorender in/a.vti b.jpg
