# exit: 3
# stderr: isorender: in/ball.mha: *
python3 -c 'from check import *; ball("in/ball.mha")'
truncate -s -1 in/ball.mha
isorender in/ball.mha
