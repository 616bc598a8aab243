# exit: 3
# stderr: isorender: in/c.isokeys: part 1 of 2 is in in/1.isokeys already
for k in 1 2; do isorender scene:ct:48 --part $k/2 -o in/$k.isokeys --quiet; done
cp in/1.isokeys in/c.isokeys
isorender merge in/*.isokeys -o a.png
