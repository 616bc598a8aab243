"""What the cases of the command line's tests share: small volumes, and looking into what came out."""
import json
import struct
import sys
import zlib


def expect(condition, *what):
    if not condition:
        print("not as expected:", *what)
        sys.exit(1)


def volume(path, dims, value, kind="MET_FLOAT", code="f", header=""):
    """Writes a .mha whose voxel (x, y, z) is value(x, y, z)."""
    data = [value(x, y, z) for z in range(dims[2]) for y in range(dims[1]) for x in range(dims[0])]
    with open(path, "wb") as file:
        file.write(("ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\n%sElementType = %s\nElementByteOrderMSB = False\n"
                    "ElementDataFile = LOCAL\n" % (*dims, header, kind)).encode())
        file.write(struct.pack("<%d%s" % (len(data), code), *data))


def ball(path, side=24, radius=8.0, header=""):
    """A ball of value 1000 at its centre, 0 at twice its radius; its surface is at 500."""
    middle = (side - 1) / 2

    def value(x, y, z):
        distance = ((x - middle) ** 2 + (y - middle) ** 2 + (z - middle) ** 2) ** 0.5
        return max(0.0, 1000 - 500 * distance / radius)

    volume(path, (side, side, side), value, header=header)


def report(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Png:
    """A PNG of 8-bit RGB or RGBA: size, texts, rows of RGBA tuples."""

    def __init__(self, path):
        data = open(path, "rb").read()
        expect(data[:8] == b"\x89PNG\r\n\x1a\n", path, "is not a PNG")
        self.texts, packed, at = {}, b"", 8
        while at < len(data):
            length, kind = struct.unpack(">I4s", data[at:at + 8])
            body = data[at + 8:at + 8 + length]
            expect(zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0], "crc", kind)
            if kind == b"IHDR":
                self.width, self.height, depth, color = struct.unpack(">IIBB", body[:10])
                expect(depth == 8 and color in (2, 6), "depth and colour type", depth, color)
                self.channels = 3 if color == 2 else 4
            elif kind == b"tEXt":
                key, text = body.split(b"\0", 1)
                self.texts[key.decode()] = text.decode("latin-1")
            elif kind == b"IDAT":
                packed += body
            at += 12 + length
        self.rows = self._rows(zlib.decompress(packed))

    def _rows(self, raw):
        n, stride, rows, above = self.channels, self.width * self.channels, [], None
        for y in range(self.height):
            kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            above = above or bytearray(stride)
            for i in range(stride):
                a = line[i - n] if i >= n else 0
                b, c = above[i], above[i - n] if i >= n else 0
                p = a + b - c
                nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[i] = (line[i] + (0, a, b, (a + b) // 2, nearest)[kind]) & 255
            above = line
            rows.append([tuple(line[i:i + n]) + ((255,) if n == 3 else ()) for i in range(0, stride, n)])
        return rows

    def pixels(self):
        return [pixel for row in self.rows for pixel in row]
