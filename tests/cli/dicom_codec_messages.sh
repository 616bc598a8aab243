# What a codec of compressed DICOM writes to standard error is a part of the program's own line.
python3 - <<'P'
import subprocess
import sys
from check import *
from dicom_slices import *

# A lossless JPEG of 16 x 16 pixels of 16 bits, whose only Huffman code is 0: all other bits are damage.
head = b"\xff\xd8\xff\xc3" + struct.pack(">HBHHBBBB", 11, 16, SIDE, SIDE, 1, 1, 0x11, 0)
table = b"\xff\xc4" + struct.pack(">HB16B", 20, 0, 1, *[0] * 15) + b"\0"
scan = b"\xff\xda" + struct.pack(">HBBBBBB", 8, 1, 1, 0, 1, 0, 0)
for name, data in (("good", b"\0" * 32), ("bad", b"\0" * 8 + b"\xff\0" * 24)):
    slice_of("in/%s/a.dcm" % name, 0, jpeg=head + table + scan + data + b"\xff\xd9")
good = subprocess.run(["isorender", "in/good", "--info", "--quiet"], capture_output=True, text=True)
if "built without" in good.stderr or "not installed" in good.stderr:
    print("skipped: built without GDCM")
    sys.exit(77)
expect(good.returncode == 0 and good.stderr == "", good.returncode, good.stderr)
bad = subprocess.run(["isorender", "in/bad", "--info"], capture_output=True, text=True)
expect(bad.stderr.count("Corrupt JPEG data") == 1, bad.stderr)
expect(all(line.startswith("isorender: ") for line in bad.stderr.splitlines()), bad.stderr)
P
