# exit: 2
# stderr: isorender: *only dense ones have chunks*
isorender scene:sphere --part 1/2 -o a.isokeys
