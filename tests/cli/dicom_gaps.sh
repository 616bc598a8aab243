# Slices of a DICOM series that are missing are counted, and their places named, wherever most or few are missing.
python3 - <<'P'
import shutil
import subprocess
from check import *
from dicom_slices import *


def refused(there, text):
    shutil.rmtree("in/a", ignore_errors=True)
    for z in there:
        slice_of("in/a/im%02d.dcm" % z, z, z + 1)
    done = subprocess.run(["isorender", "in/a", "--info"], capture_output=True, text=True)
    expect(done.returncode == 3 and done.stderr == "isorender: in/a: %s\n" % text, done.returncode, done.stderr)


one = "1 slice is missing: a gap of 3 mm between im04.dcm (at 6) and im06.dcm (at 9), elsewhere 1.5"
refused([z for z in range(12) if z != 5], one)
refused([0, 1, 2, 5, 6, 9], "4 slices are missing in 2 gaps, at 3 .. 7.5, 9 .. 13.5 mm, elsewhere slices are 1.5 mm apart")
refused([z for z in range(32) if z < 2 or z % 2], "15 slices are missing in 15 gaps, at 1.5 .. 4.5, 4.5 .. 7.5, 7.5 .. 10.5, "
        "10.5 .. 13.5, 13.5 .. 16.5, 16.5 .. 19.5 mm and so on, elsewhere slices are 1.5 mm apart")
refused([0, 3, 6, 7], "4 slices are missing in 2 gaps, at 0 .. 4.5, 4.5 .. 9 mm, elsewhere slices are 1.5 mm apart")
P
