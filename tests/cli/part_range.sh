# exit: 2
# stderr: isorender: option --part: '3/2' is not K/N*
isorender scene:ct:32 --part 3/2 -o a.isokeys
