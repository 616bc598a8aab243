# exit: 6
# stderr: isocompare: in/c.mha: the volume is constant
python3 -c 'from check import *; volume("in/c.mha", (16, 16, 16), lambda x, y, z: 3.0)'
isocompare report in/c.mha --output made --quiet
