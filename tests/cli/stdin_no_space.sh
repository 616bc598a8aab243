# exit: 7
# stderr: isorender: */run: cannot copy standard input here: File too large
python3 -c 'from check import *; volume("in/b.mha", (128, 128, 64), lambda x, y, z: 0)'
ulimit -f 1024
export TMPDIR=$PWD
isorender - out.png < <(cat in/b.mha)
