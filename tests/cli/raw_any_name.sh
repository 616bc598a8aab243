# --raw reads a volume, also from a file that has the name of a mesh, of lines or of points.
for extension in stl STL swc pdb xyz ply; do
    head -c 4096 /dev/zero >in/a.$extension
    isorender in/a.$extension --raw 16x16x16:uint8 --info >said
    grep -q '16 x 16 x 16' said
done
