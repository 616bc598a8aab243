# exit: 3
# stderr: isorender: in/2.isokeys: part 2 of 2 is of another surface than in/1.isokeys
isorender scene:ct:48 --part 1/2 -o in/1.isokeys --quiet
isorender scene:ct:48 --part 2/2 -o in/2.isokeys --isovalue 99 --quiet
isorender merge in/1.isokeys in/2.isokeys -o a.png
