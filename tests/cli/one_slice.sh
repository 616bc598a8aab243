python3 -c 'from check import *; volume("in/a.mha", (8, 8, 1), lambda x, y, z: 10.0 * x)'
isorender in/a.mha out.png --isovalue 35
