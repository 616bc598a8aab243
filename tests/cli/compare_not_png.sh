# exit: 3
# stderr: isocompare: in/a.png: *
echo hello >in/a.png
isocompare images in/a.png in/a.png
