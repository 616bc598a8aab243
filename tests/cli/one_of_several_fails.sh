# exit: 3
# stderr: isorender: in/missing.mha: *
python3 -c 'from check import *; ball("in/ball.mha")'
status=0
isorender in/missing.mha in/ball.mha --resolution 32x32 --quiet --output 'in/{model}.png' || status=$?
[ -f in/ball.png ] && [ ! -e in/missing.png ]
exit $status
