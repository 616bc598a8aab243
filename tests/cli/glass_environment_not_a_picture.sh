# exit: 3
# stderr: isorender: in/none.png: *
echo "no picture" >in/none.png
isorender scene:sphere:16 a.png --ior 1.5 --environment in/none.png
