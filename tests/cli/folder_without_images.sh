mkdir in/folder
echo "no image" >in/folder/readme.txt
isorender in/folder
