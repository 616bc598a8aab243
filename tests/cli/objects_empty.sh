# exit: 6
# stderr: isorender: in/none.swc: *
echo "# nothing" >in/none.swc
isorender --lines in/none.swc a.png
