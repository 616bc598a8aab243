python3 - <<'P'
import subprocess
from check import *
# Strings of a legacy VTK header are shown by --info and in messages.
head = b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 8\n"
name = b"n\x1b[31m\xff\xc2\x9b"
open("in/a.vtk", "wb").write(head + b"SCALARS " + name + b" float 1\nLOOKUP_TABLE default\n0 1 0 1 0 1 0 1\n")
done = subprocess.run(["isorender", "in/a.vtk", "--info"], capture_output=True)
expect(done.returncode == 0, done)
expect("n\\x1b[31m\\xff\\xc2\\x9b" in done.stdout.decode(), done.stdout)
expect(b"\x1b" not in done.stdout + done.stderr, done)
open("in/b.nrrd", "wb").write(b"NRRD0004\ntype: \x1b[31m\xff\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678")
done = subprocess.run(["isorender", "in/b.nrrd", "out.png"], capture_output=True)
expect(done.returncode == 3, done)
expect(b"\x1b" not in done.stderr and done.stderr.count(b"\n") == 1 and done.stderr.decode(), done.stderr)
P
