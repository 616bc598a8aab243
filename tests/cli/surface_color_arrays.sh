# --surface-color-by takes the name of an array of the input, as it takes FILE:ARRAY; what is neither a file nor an array is
# refused with the arrays that there are; --cap surface says that it has the surface's plain colour.
python3 - <<'P'
n = 16
places = [(x, y, z) for z in range(n) for y in range(n) for x in range(n)]
with open("in/two.vtk", "w") as f:
    f.write("# vtk DataFile Version 3.0\ntwo arrays\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS %d %d %d\n" % (n, n, n))
    f.write("ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA %d\n" % n**3)
    for name, value in (("ball", lambda x, y, z: 100 - (x - 8) ** 2 - (y - 8) ** 2 - (z - 8) ** 2), ("heat", lambda x, y, z: x)):
        f.write("SCALARS %s float 1\nLOOKUP_TABLE default\n" % name)
        f.write("\n".join(str(value(*p)) for p in places) + "\n")
P
options="in/two.vtk --grid ball --isovalue 60 --resolution 80x80 --quiet"
isorender $options --surface-color-by heat word.png
isorender $options --surface-color-by in/two.vtk:heat whole.png
isorender $options plain.png
isorender --again word.png again.png --quiet
python3 - <<'P'
from check import *
word = Png("word.png")
expect(word.rows == Png("whole.png").rows and word.rows != Png("plain.png").rows)
expect(word.rows == Png("again.png").rows)
P
refuses 2 "no array 'warmth', there are 'ball', 'heat'" isorender $options --surface-color-by warmth bad.png || exit 1
refuses 3 "warmth.nrrd: cannot read" isorender $options --surface-color-by warmth.nrrd bad.png || exit 1
isorender in/two.vtk --grid ball --isovalue 60 --surface-color-by heat --clip x --cap surface cap.png 2>notes
grep -q "note: --cap surface has the surface's plain colour" notes
