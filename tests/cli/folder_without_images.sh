# exit: 3
# stderr: isorender: in/folder: *
mkdir in/folder
echo "no image" >in/folder/readme.txt
isorender in/folder
