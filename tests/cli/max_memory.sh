# exit: 5
# stderr: isorender: in/ball.mha: *--max-memory*
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --max-memory 20k
