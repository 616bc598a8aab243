# A grid whose name has a zero byte in it, which no --grid can name, is read like any other.
isosculpt --replay $volumes/bear.strokes --headless --voxel-size 2 --output a.vdb --quiet 2>error.txt || { grep -q "not installed" error.txt && { echo "skipped: without OpenVDB"; exit 77; }; cat error.txt; exit 1; }
python3 - <<'P'
data = open("a.vdb", "rb").read()
assert b"surface" in data
open("b.vdb", "wb").write(data.replace(b"surface", b"sur\0\0ab"))
P
isorender a.vdb a.png --resolution 32x32 --quiet
isorender b.vdb b.png --resolution 32x32 --quiet
isorender b.vdb --info | grep -q level
