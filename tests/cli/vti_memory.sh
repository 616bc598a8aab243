# exit: 3
# stderr: isorender: in/a.vti: refused*
# A block of 256 MB, packed into 250 kB, for 16^3 voxels: nothing of it is unpacked.
python3 - <<'P'
import struct
import zlib

packer = zlib.compressobj(9)
packed = b"".join(packer.compress(bytes(1 << 20)) for _ in range(256)) + packer.flush()
before = """<?xml version="1.0"?>
<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian" compressor="vtkZLibDataCompressor">
<ImageData WholeExtent="0 15 0 15 0 15" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="0 15 0 15 0 15">
<PointData Scalars="s"><DataArray type="UInt8" Name="s" format="appended" offset="0"/></PointData></Piece></ImageData>
<AppendedData encoding="raw">
_"""
numbers = struct.pack("<4I", 1, 256 << 20, 0, len(packed))
with open("in/a.vti", "wb") as file:
    file.write(before.encode() + numbers + packed + b"\n</AppendedData>\n</VTKFile>\n")
P
python3 - <<'P'
import resource
import subprocess
import sys
from check import *

run = subprocess.run(["isorender", "in/a.vti", "out.png", "--max-memory", "64M"], capture_output=True, text=True)
expect(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 128 * 1024, "took too much memory")
expect("corrupt" in run.stderr or "VTK" in run.stderr, run.stderr)
sys.stderr.write("isorender: in/a.vti: refused\n")
sys.exit(run.returncode)
P
