# Several DICOM images at the same places are acquisitions of one series: told apart by acquisition or instance number. The first is
# read, or the one of the named file or of --series N:K; --info lists them.
python3 - <<'P'
import os
import shutil
import subprocess
from check import *
from dicom_slices import *


def read(path, value, *options, note=""):
    done = subprocess.run(["isorender", path, "--info", "--json=j.json", *options], capture_output=True, text=True)
    expect(done.returncode == 0, path, options, done.stderr)
    got = report("j.json")
    expect(got["volume"]["dims"] == [SIDE, SIDE, 10], got["volume"])
    expect(100 * value <= got["value_range"][1] - 80 < 100 * value + 20, path, options, value, got["value_range"])
    expect(not note or any(note in n for n in got["volume"]["notes"]), got["volume"]["notes"])
    return got["volume"]


def refused(path, text, status, *options):
    done = subprocess.run(["isorender", path, "--info", *options], capture_output=True, text=True)
    expect(done.returncode == status and text in done.stderr and done.stderr.count("\n") == 1, path, done.returncode, done.stderr)


def write(folder, number, acquisition=lambda time, z: None, left_out=()):
    """Three times of ten slices; the later ones are named first."""
    shutil.rmtree(folder, ignore_errors=True)
    for time in range(3):
        for z in range(10):
            if (time, z) not in left_out:
                slice_of("%s/%s%02d.dcm" % (folder, "cba"[time], z), z, number(time, z), value=100 * time,
                         acquisition=acquisition(time, z))


for number, acquisition in ((lambda time, z: 10 * time + z, lambda time, z: None),  # one time after the other
                            (lambda time, z: 3 * z + time, lambda time, z: None),  # one place after the other
                            (lambda time, z: z, lambda time, z: time + 5),
                            (lambda time, z: 3 * z + time, lambda time, z: 3 * z + time)):
    write("in/a", number, acquisition)
    found = read("in/a", 0, note="3 acquisitions at the same places: using number 1, 20 images of others are left out (--series 1:3)")
    expect(found["items"] == ["1  CT  16x16x10  -  (30 images, 3 acquisitions: 1:1 .. 1:3)  1.2.3"], found["items"])
    read("in/a", 1, "--series", "1:2", note="using number 2")
    read("in/a", 2, "--series", "1.2.3:3")
    read("in/a/a07.dcm", 2, note="using number 3")
    read("in/a/a07.dcm", 1, "--series", "1:2")
refused("in/a", "series 1 has no acquisition 4, there are 3", 2, "--series", "1:4")
for wrong in ("1:", "1:0", "1:x", ":1:"):
    refused("in/a", "--series", 2, "--series", wrong)

# One time lacks a slice: a whole one is taken.
write("in/a", lambda time, z: 10 * time + z, left_out=[(0, 4)])
read("in/a", 1, note="using number 2, 19 images")
refused("in/a", "1 slice is missing", 3, "--series", "1:1")
write("in/a", lambda time, z: z, lambda time, z: time, left_out=[(1, 4), (1, 5)])
read("in/a", 0)
read("in/a", 2, "--series", "1:3")

# Images with the same unique identifier are copies of one file: all but one are left out.
for z in range(10):
    slice_of("in/c/%d.dcm" % z, z, z, instance=b"1.5.%d" % z)
slice_of("in/c/3 copy.dcm", 3, 3, instance=b"1.5.3")
read("in/c", 0, note="a copy of 3 copy.dcm is left out")
slice_of("in/c/5 copy.dcm", 5, 5, instance=b"1.5.5")
slice_of("in/c/5 copy 2.dcm", 5, 5, instance=b"1.5.5")
read("in/c", 0, note="3 copies of images are left out")

# Images without one cannot be told from copies.
write("in/a", lambda time, z: z)
refused("in/a", "lie at the same place", 3)
P
