# exit: 3
# stderr: isorender: in/a.isokeys: not a file of keys (.isokeys)
echo "ISOKEYS, or not" >in/a.isokeys
isorender merge in/a.isokeys -o a.png
