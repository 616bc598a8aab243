# exit: 6
# stderr: isorender: in/ball.mha: no surface at isovalue -3: *
python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500,-3 --json=j.json
