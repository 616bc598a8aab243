# A .vti whose values are appended as raw bytes is drawn in chunks when it does not fit into --max-memory, with the bytes of the
# picture of the whole: mapped where they lie, or unpacked if they are not aligned or of another type. Others are read whole.
python3 - <<'P'
import base64
import math
import os
import subprocess
from check import *

dims = (150, 131, 141)
value = lambda x, y, z: int(500 + 300 * math.sin(x / 9) * math.cos(y / 7) + 150 * math.sin(z / 8 + x / 19))
row = [value(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]
count = len(row)
little, other = struct.pack("<%dh" % count, *row), bytes(2 * count)
box = "7 %d -3 %d 0 %d" % (dims[0] + 6, dims[1] - 4, dims[2] - 1)


def write(name, data=little, kind="Int16", pad=0, order="LittleEndian", length=None, offset=None, first=b""):
    """One or two arrays, of which the last is the scalars; 64-bit numbers before arrays."""
    arrays = '<DataArray type="Int16" Name="t" format="appended" offset="0"/>' if first else ""
    place = len(first) if offset is None else offset
    head = ('<VTKFile type="ImageData" version="1.0" byte_order="%s" header_type="UInt64"><ImageData WholeExtent="%s" '
            'Origin="1 2 3" Spacing="1 1.5 2" Direction="0 1 0 1 0 0 0 0 1"><Piece Extent="%s"><PointData Scalars="s">%s'
            '<DataArray type="%s" Name="s" format="appended" offset="%s"/></PointData></Piece></ImageData>'
            '<AppendedData encoding="raw">' % (order, box, box, arrays, kind, place))
    head += " " * ((pad - len(head) - 1) % 8) + "_"
    length = len(data) if length is None else length
    with open("in/" + name, "wb") as file:
        file.write(head.encode() + first + struct.pack("<Q" if order[0] == "L" else ">Q", length) + data + b"</AppendedData></VTKFile>")


def run(*arguments):
    done = subprocess.run(["isorender", *arguments, "--resolution", "160x120", "--isovalue", "520.5", "--quiet", "--camera", "iso", "--fit", "box",
                           "--threads", "2"], capture_output=True, text=True)
    return done.returncode, done.stderr


write("plain.vti")
status, text = run("in/plain.vti", "whole.png")
if status == 3 and ("built without" in text or "is not installed" in text):
    raise SystemExit(0)
expect(status == 0, text)
write("odd.vti", pad=1)
write("second.vti", first=struct.pack("<Q", 2 * count) + other)
write("big.vti", struct.pack(">%dh" % count, *row), order="BigEndian")
write("double.vti", struct.pack("<%dd" % count, *row), "Float64")
for name in ("plain.vti", "odd.vti", "second.vti", "big.vti", "double.vti"):
    status, text = run("in/" + name, "-o", "all.png")
    expect(status == 0 and Png("all.png").rows == Png("whole.png").rows, name, text)
    for more in (("--max-memory", "5M"), ("--chunk-size", "48"), ("--max-memory", "5M")):
        status, text = run("in/" + name, "-o", "a.png", *more)
        expect(status == 0 and open("a.png", "rb").read() == open("all.png", "rb").read(), name, more, text)
    expect(os.path.exists("in/%s.isoindex" % name), name)
status, text = run("in/second.vti", "-o", "a.png", "--grid", "t", "--max-memory", "5M")
expect(status == 6, status, text)  # all zero

# in base64 it is read whole, within the limit
write("base64.vti")
with open("in/base64.vti", "rb") as file:
    head = file.read().split(b'"raw">')[0] + b'"base64">'
with open("in/base64.vti", "wb") as file:
    file.write(head + b"_" + base64.b64encode(struct.pack("<Q", 2 * count) + little) + b"</AppendedData></VTKFile>")
expect(run("in/base64.vti", "-o", "a.png")[0] == 0 and Png("a.png").rows == Png("whole.png").rows)
status, text = run("in/base64.vti", "-o", "b.png", "--max-memory", "5M")
expect(status == 5 and "in/base64.vti: needs" in text and not os.path.exists("b.png"), status, text)

# damaged
cases = {"short": dict(data=little[:-40]), "length": dict(length=2 * count - 1), "offset": dict(offset=2 * count + 400),
         "far": dict(offset=1 << 62), "minus": dict(offset=-8), "text": dict(offset="x")}
for case, changes in cases.items():
    write("%s.vti" % case, **changes)
    for more in ((), ("--max-memory", "5M")):
        status, text = run("in/%s.vti" % case, "-o", "b.png", *more)
        expect(status == 3 and text.startswith("isorender: in/%s.vti: " % case) and text.count("\n") == 1, case, more, status, text)
        expect(not os.path.exists("b.png"), case)
P
