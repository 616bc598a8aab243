# exit: 3
# stderr: isorender: in/missing.trk: *No such file*
isorender --lines in/missing.trk a.png
