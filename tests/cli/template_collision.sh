# exit: 2
# stderr: isorender: a.png: two outputs have this name
isorender in/a.vti in/a.mha --output "{model}.png"
