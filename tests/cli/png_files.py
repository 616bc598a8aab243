"""PNG files that the cases of the command line's tests write."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "hostile"))
from seeds import png_chunk, png_file  # noqa: E402, F401


def interlaced_rows(size, value):
    """The rows of the passes of Adam7 of an image of 8-bit greys value(x, y)."""
    for x0, y0, dx, dy in (0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2):
        for y in range(y0, size[1], dy):
            if x0 < size[0]:
                yield bytes(value(x, y) for x in range(x0, size[0], dx))
