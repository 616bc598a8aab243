# exit: 3
# stderr: isosculpt: *damaged at line 20*
sed "20s/radius/radios/" $volumes/bear.strokes > in/d.strokes; isosculpt --replay in/d.strokes --headless --output in/d.ply || { s=$?; [ ! -e in/d.ply ] || exit 1; exit $s; }
