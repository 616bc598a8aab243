"""Small DICOM files for the cases of the command line's tests."""
import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "hostile"))
from seeds import dicom_element  # noqa: E402

SIDE = 16
PLAIN, JPEG = b"1.2.840.10008.1.2.1", b"1.2.840.10008.1.2.4.70"


def whole(path, storage, elements, syntax=PLAIN):
    """Writes a file of a storage class, with `elements` as its data set."""
    meta = dicom_element(2, 2, b"UI", storage) + dicom_element(2, 0x10, b"UI", syntax)
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as file:
        file.write(b"\0" * 128 + b"DICM" + dicom_element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + elements)


def slice_of(path, z, number=1, series=b"1.2.3", value=0, acquisition=None, spacing=1.5, jpeg=None, instance=None):
    """Slice z of a ball of values up to 100 + `value`. `jpeg`: its pixels are this stream instead."""
    middle = (SIDE - 1) / 2
    pixels = [max(0, int(100 + value - 12 * (((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2) ** 0.5)))
              for y in range(SIDE) for x in range(SIDE)]
    data = struct.pack("<%dh" % len(pixels), *pixels)
    elements = [(0x08, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2"), (0x08, 0x60, b"CS", b"CT"), (0x20, 0x0D, b"UI", b"1.2"),
                (0x20, 0x0E, b"UI", series)]
    if instance is not None:
        elements.insert(1, (0x08, 0x18, b"UI", instance))
    if acquisition is not None:
        elements.append((0x20, 0x12, b"IS", b"%d" % acquisition))
    elements += [(0x20, 0x13, b"IS", b"%d" % number), (0x20, 0x32, b"DS", b"0\\0\\%g" % (spacing * z)),
                 (0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"), (0x28, 2, b"US", struct.pack("<H", 1)),
                 (0x28, 4, b"CS", b"MONOCHROME2"), (0x28, 0x10, b"US", struct.pack("<H", SIDE)),
                 (0x28, 0x11, b"US", struct.pack("<H", SIDE)), (0x28, 0x30, b"DS", b"1\\1")]
    elements += [(0x28, 0x100 + i, b"US", struct.pack("<H", n)) for i, n in enumerate((16, 16, 15, 1))]
    body = b"".join(dicom_element(*e) for e in elements)
    if jpeg is None:
        body += dicom_element(0x7FE0, 0x10, b"OW", data)
    else:
        item = struct.pack("<HHI", 0xFFFE, 0xE000, len(jpeg) + len(jpeg) % 2) + jpeg + b"\0" * (len(jpeg) % 2)
        body += b"\xe0\x7f\x10\0OB\0\0\xff\xff\xff\xff" + struct.pack("<HHI", 0xFFFE, 0xE000, 0) + item
        body += struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    whole(path, b"1.2.840.10008.5.1.4.1.1.2", body, PLAIN if jpeg is None else JPEG)


def cut(path, length):
    with open(path, "r+b") as file:
        file.truncate(length)
