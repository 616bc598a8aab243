# The report of a part of a picture: of a camera, and of no picture.
python3 -c 'from check import *; ball("in/ball.mha", 32, 10)'
isorender in/ball.mha --part 1/2 -o out.isokeys --resolution 24x24 --quiet --json=report.json
python3 - <<'P'
from check import *
said = report("report.json")
expect("camera" in said and "image" not in said, said)
P
