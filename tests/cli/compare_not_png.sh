echo hello >in/a.png
isocompare images in/a.png in/a.png
