# exit: 3
# stderr: isorender: part 2 of 3 is missing*
for k in 1 3; do isorender scene:ct:48 --part $k/3 -o in/$k.isokeys --quiet; done
isorender merge in/1.isokeys in/3.isokeys -o a.png
