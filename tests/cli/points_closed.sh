# A file of the points of a closed surface says so: by pull-push its picture is that of the volume, in which points
# that face away are left out. Parts of the surface, and points with normals of another's making, are not closed.
for scene in sphere:128 torus:128; do
    isorender scene:$scene --no-image --points points.ply -q
    grep -aq "^comment closed surface of [0-9]* points$" points.ply
    for zoom in 1 3; do
        how="--method pullpush --camera iso --fit box --resolution 400x400 --zoom $zoom -q"
        isorender scene:$scene $how -o volume.png
        isorender points.ply $how -o points.png
        isocompare images volume.png points.png --fail-under psnr_in=35 > told.txt
    done
done

isorender points.ply --no-image --points again.ply -q
grep -aq "^comment closed" again.ply
isorender points.ply --no-image --crop-mm 0,64,0,128,0,128 --points part.ply -q
isorender points.ply --no-image --normals auto --points normals.ply -q
sed "s/closed surface of [0-9]* points/closed surface of 3 points/" points.ply > few.ply
isorender few.ply --no-image --points other.ply -q
isorender scene:gyroid:48 --no-image --points border.ply -q
for file in part normals other border; do
    if grep -aq "^comment closed" $file.ply; then
        echo "$file.ply is not closed"
        exit 1
    fi
done

# Points of a level set do not tear where it has narrow creases, as between the bear's arm and body: files that
# isosculpt and isorender write, and pictures of its volume. (Foot points: holes in 0.021 % and 29.8 dB.)
side="--azimuth 25 --elevation 8 --resolution 512x512 --samples 1 -q"
isosculpt --headless --replay "$volumes/bear.strokes" --output bear.ply --quiet
isosculpt --headless --replay "$volumes/bear.strokes" --output bear.vdb --quiet
isorender bear.vdb --no-image --points same.ply -q
isorender bear.vdb $side --method raycast -o rays.png
isorender bear.vdb $side --method splats -o volume.png
isorender bear.ply $side -o bear.png
isorender same.ply $side -o same.png
for picture in volume bear same; do
    isocompare images rays.png $picture.png --fail-under psnr_in=30.8 --fail-under holes=0.002 > told.txt
done
