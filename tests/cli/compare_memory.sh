# exit: 5
# stderr: isocompare: in/big.png: comparing 268 million pixels needs * MB, limit is 268 MB (--max-memory)
# The pictures' headers say what comparing them takes: nothing is decoded that does not fit.
python3 - <<'P'
import struct, zlib
def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
side, packer = 16384, zlib.compressobj(1)
row = b"\0" + bytes(side // 8)
body = b"".join(packer.compress(row) for y in range(side)) + packer.flush()
open("in/big.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 1, 0, 0, 0, 0)) +
                               chunk(b"IDAT", body) + chunk(b"IEND", b""))
P
isorender scene:sphere:16 in/small.png --resolution 64x64 --quiet
isocompare images in/small.png in/small.png --max-memory 1M --quiet
python3 - <<'P'
import resource
import subprocess
import sys
from check import *

run = subprocess.run(["isocompare", "images", "in/big.png", "in/big.png", "--max-memory", "256M"])
expect(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 256 * 1024, "took too much memory")
sys.exit(run.returncode)
P
