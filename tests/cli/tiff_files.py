"""TIFF files that the command line's tests write."""
import struct


def tiff(path, size, planes, bits=8, kind=1, description=None, headers="behind", pack=None):
    """Writes an image of one strip for each of `planes`, the bytes of its pixels; an item may be (size, bytes). kind: 1 unsigned,
    2 signed, 3 float. headers: "behind" each image, as libtiff writes them, or "last": the first one in front of all images and
    the others behind all, as tifffile does. pack: a function that makes deflate of bytes. Returns the places of the headers."""
    out, places, link = bytearray(b"II*\0\0\0\0\0"), [], 4

    def header(plane, at, length, text):
        nonlocal link
        width, height = size if isinstance(plane, bytes) else plane[0]
        entries = [(256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, bits), (259, 3, 1, 8 if pack else 1), (262, 3, 1, 1),
                   (273, 4, 1, at), (277, 3, 1, 1), (278, 4, 1, height), (279, 4, 1, length), (339, 3, 1, kind)]
        end = len(out) + 2 + 12 * (len(entries) + (text is not None)) + 4
        if text is not None:
            entries.insert(5, (270, 2, len(text) + 1, end))
        struct.pack_into("<I", out, link, len(out))
        places.append(len(out))
        out.extend(struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries))
        link = len(out)
        out.extend(bytes(4) + (text.encode() + b"\0" if text is not None else b""))

    stored = [plane if isinstance(plane, bytes) else plane[1] for plane in planes]
    stored = [pack(data) for data in stored] if pack else stored
    if headers == "last":
        at = len(out) + 2 + 12 * (11 if description else 10) + 4 + (len(description.encode()) + 1 if description else 0)
        header(planes[0], at, len(stored[0]), description)
        for data in stored:
            out += data
        for plane, data in list(zip(planes, stored))[1:]:
            at += len(stored[len(places) - 1])
            header(plane, at, len(data), None)
    else:
        for plane, data in zip(planes, stored):
            at = len(out)
            out += data
            header(plane, at, len(data), None if places else description)
    with open(path, "wb") as file:
        file.write(out)
    return places
