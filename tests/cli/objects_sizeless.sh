# exit: 6
# stderr: isorender: in/dots.csv: nothing to draw: every size is 0
printf 'x,y,z,radius\n0,0,0,0\n1,0,0,0\n' >in/dots.csv
isorender --glyphs in/dots.csv a.png
