# exit: 3
# stderr: isorender: in/a.txt: *
echo "this is not a volume" >in/a.txt
isorender in/a.txt
