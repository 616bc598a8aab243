# A FIFO is read as the input of isorender only; every other file must be a regular one, and is refused at once.
isorender scene:sphere:24 a.png --aov a.exr --mesh a.stl --resolution 32x32 --quiet || isorender scene:sphere:24 a.png --mesh a.stl --resolution 32x32 --quiet
mkfifo in/pipe in/pipe.png in/pipe.exr in/pipe.stl in/pipe.ply in/pipe.obj in/pipe.strokes
refused() { # refused FILE PROGRAM ARGUMENTS
    local status=0
    timeout 20 "${@:2}" 2>said >/dev/null || status=$?
    if [ $status -ne 3 ] || [ "$(grep -c '' said)" -ne 1 ] || ! grep -q "in/$1: not a " said; then
        echo "$*: status $status: $(cat said)"
        exit 1
    fi
}
refused pipe.png isocompare images in/pipe.png a.png
refused pipe.png isocompare images a.png in/pipe.png
if [ -e a.exr ]; then refused pipe.exr isocompare images a.png a.png --aov-a in/pipe.exr; fi
for kind in stl ply obj; do
    refused pipe.$kind isosculpt --open in/pipe.$kind --headless --output out.stl
done
refused pipe isosculpt --open in/pipe --isovalue 1 --headless --output out.stl
refused pipe.strokes isosculpt --replay in/pipe.strokes --headless --output out.stl
[ ! -e out.stl ]
