# exit: 2
# stderr: isosculpt: --recover needs a window; with --headless the session is played by --replay */in/state/isopoint/left.strokes
export XDG_STATE_HOME=$PWD/in/state
status=0
isosculpt --recover --headless 2>in/none.txt || status=$?
[ $status -eq 2 ]
grep -q -- "--recover needs a window, and $PWD/in/state/isopoint holds no session that was not closed" in/none.txt
[ ! -e in/state ]
mkdir -p in/state/isopoint
cp "$volumes/bear.strokes" in/state/isopoint/left.strokes
touch in/state/isopoint/left.strokes.open
isosculpt --recover --headless
