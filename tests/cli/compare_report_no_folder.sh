# exit: 7
# stderr: isocompare: in/file: cannot make this folder: Not a directory
echo x >in/file
isocompare report scene:torus:32 --output in/file
