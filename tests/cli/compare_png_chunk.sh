# exit: 3
# stderr: isocompare: in/a.png: PNG file ends too early
# A text chunk says that it has 512 MB, which libpng would allocate before it reads them.
python3 - <<'P'
import resource
import struct
import subprocess
import sys
import zlib
from check import *

def chunk(kind, body, length):
    return struct.pack(">I", length) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
text = b"Title\0a"
with open("in/a.png", "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 8, 8, 8, 2, 0, 0, 0), 13) +
               chunk(b"tEXt", text, 512 << 20) + chunk(b"IDAT", zlib.compress(bytes(8 * 25)), 0))
run = subprocess.run(["isocompare", "images", "in/a.png", "in/a.png", "--max-memory", "64M"])
expect(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 256 * 1024, "took too much memory")
sys.exit(run.returncode)
P
