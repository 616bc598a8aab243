# What lies beside a DICOM series is left out with one note, whether a folder or a file is named: files that are not DICOM, cut or
# of another kind, and copies of the named file. A slice of the series that cannot be read is an error, as is the named file.
python3 - <<'P'
import subprocess
from check import *
from dicom_slices import *


def run(path, *options):
    return subprocess.run(["isorender", path, "--info", "--json=j.json", *options], capture_output=True, text=True)


def refused(path, text, status=3):
    done = run(path)
    expect(done.returncode == status and text in done.stderr and done.stderr.count("\n") == 1, path, done.returncode, done.stderr)


def notes(path, slices, *options):
    done = run(path, *options)
    expect(done.returncode == 0, path, done.stderr)
    expect(report("j.json")["volume"]["dims"] == [SIDE, SIDE, slices], path, report("j.json")["volume"])
    return report("j.json")["volume"]["notes"]


for z in range(12):
    slice_of("in/a/im%02d.dcm" % z, z, z + 1)
expect(notes("in/a", 12) == [], "notes of nothing")

slice_of("in/a/another.dcm", 3, 4, series=b"1.2.9")
cut("in/a/another.dcm", 600)
for path in ("in/a", "in/a/im05.dcm"):
    said = notes(path, 12)
    expect(len(said) == 1 and said[0].startswith("1 file is left out: another.dcm: truncated"), said)
refused("in/a/another.dcm", "another.dcm: truncated")

with open("in/a/notes.dcm", "w") as file:
    file.write("not an image")
with open("in/a/empty", "w") as file:
    pass
whole("in/a/report", b"1.2.840.10008.5.1.4.1.1.88.11", dicom_element(0x20, 0x0E, b"UI", b"1.2.3"))
said = notes("in/a/im00.dcm", 12)
expect(len(said) == 1 and "4 files are left out (1 unreadable, 2 not DICOM, 1 without an image)" in said[0], said)
expect("the first: another.dcm: truncated" in said[0], said)
refused("in/a/notes.dcm", "notes.dcm: not a DICOM file")
refused("in/a/report", "holds no image")

# A damaged copy of a slice that is there does not matter; a slice that is lost does, in the middle and at an end.
slice_of("in/a/copy.dcm", 4, 5)
cut("in/a/copy.dcm", 700)
expect(len(notes("in/a", 12)) == 1, "a damaged copy")
for z in (11, 6):
    cut("in/a/im%02d.dcm" % z, 700)
    refused("in/a", "im%02d.dcm: truncated" % z)
    refused("in/a/im00.dcm", "im%02d.dcm: truncated" % z)
    slice_of("in/a/im%02d.dcm" % z, z, z + 1)
cut("in/a/im06.dcm", 250)  # ends before it says whose slice it is
refused("in/a", "1 slice is missing: a gap of 3 mm between im05.dcm (at 7.5) and im07.dcm (at 10.5), elsewhere 1.5 (left out: ")
refused("in/a/im06.dcm", "im06.dcm: truncated")

# The named file among images at its own place; a hidden file.
for name in ("x", "y", "z"):
    slice_of("in/b/%s.dcm" % name, 2, 7, value=ord(name))
expect("2 images at the place of y.dcm are left out" in notes("in/b/y.dcm", 1), report("j.json")["volume"])
expect(report("j.json")["value_range"][1] == 154, report("j.json")["value_range"])
refused("in/b", "x.dcm and y.dcm lie at the same place")
slice_of("in/c/.hidden.dcm", 0)
notes("in/c/.hidden.dcm", 1)
P
