# exit: 2
# stderr: isorender: b.gif: a picture's name must end in .png*
isorender in/a.vti b.gif
