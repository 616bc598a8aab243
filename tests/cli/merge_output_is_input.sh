# exit: 2
# stderr: isorender: *in/1.png*
isorender scene:ct:48 --part 1/1 -o in/1.isokeys --quiet
mv in/1.isokeys in/1.png
isorender merge in/1.png -o in/1.png
