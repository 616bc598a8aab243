# The root of a CD: a folder whose images are in subfolders, with a DICOMDIR or without. The largest series is read; --series chooses.
python3 - <<'P'
import os
import subprocess
from check import *
from dicom_slices import *


def read(path, slices, *options):
    done = subprocess.run(["isorender", path, "--info", "--json=j.json", *options], capture_output=True, text=True)
    expect(done.returncode == 0, path, options, done.stderr)
    expect(report("j.json")["volume"]["dims"] == [SIDE, SIDE, slices], report("j.json")["volume"])
    return report("j.json")["volume"]


def refused(path, text):
    done = subprocess.run(["isorender", path, "--info"], capture_output=True, text=True)
    expect(done.returncode == 3 and text in done.stderr and done.stderr.count("\n") == 1, path, done.returncode, done.stderr)


os.makedirs("in/cd/DICOM/empty")
refused("in/cd", "in/cd: holds no DICOM images")
for z in range(4):
    slice_of("in/cd/DICOM/PA0/ST0/SE1/IM%d" % z, z, z, series=b"1.2.3.1")
for z in range(9):
    slice_of("in/cd/DICOM/PA0/ST0/SE2/IM%d" % z, z, z, series=b"1.2.3.2")
for z in range(6):
    slice_of("in/cd/DICOM/PA0/ST1/SE1/IM%d" % z, z, z, series=b"1.2.3.3")
os.symlink("..", "in/cd/DICOM/circle")
with open("in/cd/AUTORUN.INF", "w") as file:
    file.write("[autorun]")
for _ in range(2):
    found = read("in/cd", 9)
    expect(found["notes"] == ["the images are in subfolders: DICOM/PA0/ST0/SE2", "several series: using 2 of 3, which has "
                              "most images (--series)", "1 file is left out: AUTORUN.INF: not a DICOM file"], found["notes"])
    expect([item[:18] for item in found["items"]] == ["1  CT  16x16x4  - ", "2  CT  16x16x9  - ", "3  CT  16x16x6  - "], found)
    expect(found["items"][0].endswith("1.2.3.1  DICOM/PA0/ST0/SE1"), found)
    read("in/cd/", 4, "--series", "1")
    read("in/cd", 6, "--series", "1.2.3.3")
    whole("in/cd/DICOMDIR", b"1.2.840.10008.1.3.10", dicom_element(4, 0x1130, b"CS", b"CD"))
read("in/cd/DICOMDIR", 9)
read("in/cd/DICOMDIR", 6, "--series", "3")
read("in/cd/DICOM/PA0/ST0/SE1", 4)
read("in/cd/DICOM/PA0/ST0/SE1/IM2", 4)
slice_of("in/cd/logo", 0, series=b"1.2.8")  # beside a DICOMDIR an image does not hide the others
read("in/cd", 9)
os.unlink("in/cd/DICOMDIR")
read("in/cd", 1)
os.unlink("in/cd/logo")

os.rename("in/cd/DICOM/PA0/ST0/SE2/IM5", "in/im5")
refused("in/cd", "1 slice is missing: a gap of 3 mm between DICOM/PA0/ST0/SE2/IM4 (at 6) and DICOM/PA0/ST0/SE2/IM6 (at 9), "
        "elsewhere 1.5 (series 2 of 3, --series chooses another)")
os.rename("in/im5", "in/cd/DICOM/PA0/ST0/SE2/IM5")
cut("in/cd/DICOM/PA0/ST0/SE2/IM8", 800)
refused("in/cd", "DICOM/PA0/ST0/SE2/IM8: truncated")

for i in range(40):  # more series than are listed
    slice_of("in/many/%d/a" % i, 0, series=b"1.2.3.%03d" % i)
found = read("in/many", 1, "--series", "40")
expect(len(found["items"]) == 32 and found["items"][-1] == "and 9 more, up to --series 40", found["items"])
P
