# exit: 2
# stderr: isorender: option --raw: *
isorender --raw 16x16:uint8 in/a.raw
