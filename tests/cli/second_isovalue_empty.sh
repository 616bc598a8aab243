python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha --isovalue 500,-3 --json=j.json
