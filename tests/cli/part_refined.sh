# exit: 2
# stderr: isorender: *cannot be drawn in chunks*
isorender scene:ct:32 --part 1/2 -o a.isokeys --method discs
