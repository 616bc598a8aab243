# Threads and the main program get the stack that they need, whatever the process is limited to.
ulimit -s 128
for method in exact points mesh raycast discs pullpush; do
    isorender scene:ct:48 "picture.png" --method $method --resolution 200x150 --samples 4 --threads 3 --quiet
    isorender scene:head:64 "picture.png" --method $method --resolution 200x150 --threads 1 --quiet
done
isorender scene:ct:48 --no-image --points p.ply --mesh m.stl --quiet
isocompare images picture.png picture.png >/dev/null
isosculpt --open m.stl --voxel-size 2 --headless --output o.ply --draw --extract --quiet
