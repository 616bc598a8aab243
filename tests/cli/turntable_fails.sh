# exit: 7
# stderr: isorender: in/t_001.png: cannot write: Is a directory
mkdir in/t_001.png
status=0
isorender scene:torus:32 in/t.png --turntable 3 --resolution 64x64 --quiet || status=$?
[ ! -e in/t_000.png ] || { echo "a frame was left behind"; exit 1; }
exit $status
