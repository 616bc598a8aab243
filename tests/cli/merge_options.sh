# exit: 2
# stderr: isorender: merge: the picture has the options that its parts were drawn with: --zoom=2
isorender merge in/1.isokeys -o a.png --zoom 2
