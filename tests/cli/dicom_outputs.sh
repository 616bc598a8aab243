# An output never overwrites a DICOM file that is looked at to find the series: slices of another series, files that are
# damaged or without an image, the DICOMDIR of a CD; by no link and no other name. Other files in the folder are no inputs.
python3 - <<'P'
import os
import subprocess
from check import *
from dicom_slices import *

for z in range(12):
    slice_of("in/cd/SE1/im%02d" % z, z, z + 1)
for z in range(3):
    slice_of("in/cd/SE2/im%02d" % z, z, z + 1, series=b"1.2.9")
slice_of("in/cd/SE1/cut", 3, 4, series=b"1.2.8")
cut("in/cd/SE1/cut", 600)
whole("in/cd/SE1/report", b"1.2.840.10008.5.1.4.1.1.88.11", dicom_element(0x20, 0x0E, b"UI", b"1.2.3"))
whole("in/cd/DICOMDIR", b"1.2.840.10008.1.3.10", b"")
OUTPUTS = [(["--info"], "--json=", ".json"), (["--no-image"], "--mesh=", ".stl"), (["--no-image"], "--points=", ".ply"),
           ([], "--output=", ".png"), (["--part", "1/2"], "--output=", ".isokeys")]


def content(path):
    with open(path, "rb") as file:
        return file.read()


def refused(path, link):
    for options, output, extension in OUTPUTS:
        before, name = content(path), "in/out" + extension
        link(path, name)
        done = subprocess.run(["isorender", "in/cd", "--isovalue", "50", "--resolution", "32x32", *options, output + name],
                              capture_output=True, text=True)
        expect(done.returncode == 2 and content(path) == before, path, output, done.returncode, done.stderr)
        expect("an output would overwrite the input" in done.stderr and done.stderr.count("\n") == 1, done.stderr)
        os.remove(name)


for path in "SE1/im05", "SE2/im01", "SE1/cut", "SE1/report", "DICOMDIR":
    refused("in/cd/" + path, lambda target, name: os.symlink(os.path.abspath(target), name))
    refused("in/cd/" + path, os.link)
for _ in range(2):  # what an earlier run has left in the folder is replaced
    subprocess.run(["isorender", "in/cd", "in/cd/SE1/ball.png", "--isovalue", "50", "--resolution", "32x32", "--quiet"], check=True)
P
