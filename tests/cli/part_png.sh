# exit: 2
# stderr: isorender: a.png: --part writes a file of keys*
isorender scene:ct:32 --part 1/2 -o a.png
