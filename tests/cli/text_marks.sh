# Text that editors have saved with a byte order mark is read: headers, colours, labels and scenes; headers in UTF-16 are refused by
# name.
python3 - <<'P'
voxels = " ".join(str(max(0, 200 - 20 * ((i % 8 - 4) ** 2 + (i // 8 % 8 - 4) ** 2 + (i // 64 - 4) ** 2))) for i in range(512))
open("in/voxels.raw", "wb").write(bytes(map(int, voxels.split())))
points = "".join("%g %g %g\n" % (i % 5, i // 5, i * i % 7) for i in range(25))
files = {
    "a.nhdr": "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nencoding: raw\ndata file: voxels.raw\n",
    "a.nrrd": "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nencoding: ascii\n\n" + voxels + "\n",
    "a.mhd": "NDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = voxels.raw\n",
    "volume.vtk": "# vtk DataFile Version 3.0\na\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 8 8\nORIGIN 0 0 0\nSPACING 1 1 1\n"
                  "POINT_DATA 512\nSCALARS s float 1\nLOOKUP_TABLE default\n" + voxels + "\n",
    "mesh.vtk": "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0\n9 0 0\n0 0 9\nPOLYGONS 1 4\n3 0 1 2\n",
    "a.pcd": "# .PCD v.7\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 25\nHEIGHT 1\nPOINTS 25\nDATA ascii\n" + points,
    "a.ply": "ply\nformat ascii 1.0\nelement vertex 25\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + points,
}
for name, text in files.items():
    open("in/plain_" + name, "w").write(text)
    open("in/mark_" + name, "w", encoding="utf-8-sig").write(text)
    open("in/wide_" + name, "w", encoding="utf-16").write(text)
P
for name in a.nhdr a.nrrd a.mhd volume.vtk mesh.vtk a.pcd a.ply; do
    for kind in plain mark; do
        isorender in/${kind}_$name picture.png --quiet --resolution 40x40 --json=$kind.json
    done
    python3 -c 'from check import *; expect(report("plain.json")["image"]["hash"] == report("mark.json")["image"]["hash"], "another picture")'
    isorender_refuses 3 "in/wide_$name: text in UTF-16, which is not read; save it as UTF-8" in/wide_$name
done
# a colormap, a scene, and names of labels
mark() { printf '\357\273\277' | cat - "$1"; }
printf '255 0 0\n0 255 0\n' >in/plain.txt
mark in/plain.txt >in/mark.txt
printf '200 ball 255 0 0 0\n' >in/plain_labels.txt
mark in/plain_labels.txt >in/mark_labels.txt
isorender in/plain_a.nhdr scene.png --save-scene in/plain.json --quiet --isovalue 100
mark in/plain.json >in/mark.json
for kind in plain mark; do
    isorender in/plain_a.nhdr colors.png --quiet --isovalue 100 --resolution 40x40 --surface-color-by depth --colormap in/$kind.txt --json=$kind.colors.json
    isorender in/plain_a.nhdr labels.png --quiet --resolution 40x40 --smooth --label ball --label-table in/${kind}_labels.txt --json=$kind.labels.json
    isorender in/$kind.json scene.png --quiet --resolution 40x40 --json=$kind.scene.json
done
python3 -c 'from check import *
for what in ("colors", "labels", "scene"):
    expect(report("plain.%s.json" % what)["image"]["hash"] == report("mark.%s.json" % what)["image"]["hash"], what)'
