"""What the cases of the command line's tests share: small volumes, and looking into what came out."""
import json
import struct
import sys
import zlib

CRC32C = []
for _i in range(256):
    for _ in range(8):
        _i = _i >> 1 ^ (0x82f63b78 if _i & 1 else 0)
    CRC32C.append(_i)


def expect(condition, *what):
    if not condition:
        print("not as expected:", *what)
        sys.exit(1)


def crc32c(data):
    """The checksum of strokes, indices and shards (Castagnoli), a number."""
    crc = 0xffffffff
    for byte in data:
        crc = CRC32C[(crc ^ byte) & 255] ^ (crc >> 8)
    return crc ^ 0xffffffff


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


def nifti_header(dims, kind, bits):
    """The header of a NIfTI pair: voxels of 1 mm whose NIfTI datatype is `kind`, of `bits` bits."""
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *dims, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, kind, bits)
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    header[344:348] = b"ni1\0"
    return bytes(header)


def report(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Png:
    """A PNG of 8-bit RGB, RGBA or indexed colours: size, texts, rows of RGBA tuples."""

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
                expect(depth == 8 and color in (2, 3, 6), "depth and colour type", depth, color)
                self.channels = {2: 3, 3: 1, 6: 4}[color]
            elif kind == b"PLTE":
                self.palette = [tuple(body[i:i + 3]) + (255,) for i in range(0, length, 3)]
            elif kind == b"tEXt":
                key, text = body.split(b"\0", 1)
                self.texts[key.decode()] = text.decode("latin-1")
            elif kind == b"IDAT":
                packed += body
            at += 12 + length
        self.lines = list(self._lines(zlib.decompress(packed)))
        self._rows = None

    def _lines(self, raw):
        """The bytes of each row, without their filters."""
        n, stride = self.channels, self.width * self.channels
        above = bytes(stride)
        for y in range(self.height):
            at = y * (stride + 1)
            kind, line = raw[at], bytearray(raw[at + 1:at + 1 + stride])
            if kind == 2: # up
                line = bytearray([(v + b) & 255 for v, b in zip(line, above)])
            elif kind: # sub, average, Paeth: each byte needs the one before it
                line = bytearray(n) + line # beside the first pixel
                edge = bytes(n) + above
                for i in range(n, stride + n):
                    a, b = line[i - n], edge[i]
                    if kind == 1:
                        line[i] = (line[i] + a) & 255
                    elif kind == 3:
                        line[i] = (line[i] + (a + b >> 1)) & 255
                    else:
                        c = edge[i - n]
                        p, q = abs(b - c), abs(a - c)
                        r = abs(a + b - c - c)
                        line[i] = (line[i] + (a if p <= q and p <= r else b if q <= r else c)) & 255
                del line[:n]
            above = bytes(line)
            yield above

    def row(self, y):
        n, line = self.channels, self.lines[y]
        if n == 1:
            return [self.palette[i] for i in line]
        return list(zip(line[::n], line[1::n], line[2::n], line[3::n] if n == 4 else bytes([255]) * self.width))

    @property
    def rows(self):
        if self._rows is None:
            self._rows = [self.row(y) for y in range(self.height)]
        return self._rows

    def pixels(self):
        return [pixel for row in self.rows for pixel in row]


class Exr:
    """An OpenEXR picture as --aov writes it: attributes (raw bytes), and every channel as a flat list of floats, or
    integers where its name begins with id."""

    def __init__(self, path):
        data = open(path, "rb").read()
        expect(struct.unpack("<II", data[:8]) == (20000630, 2), path, "is not a scanline OpenEXR file")
        self.attributes, at = {}, 8
        while data[at]:
            name, kind, rest = data[at:at + 600].split(b"\0", 2)
            at += len(name) + len(kind) + 2
            size = struct.unpack("<I", data[at:at + 4])[0]
            self.attributes[name.decode()] = data[at + 4:at + 4 + size]
            at += 4 + size
        expect(self.attributes["compression"] == b"\3", "not ZIP", self.attributes["compression"])
        x0, y0, x1, y1 = struct.unpack("<4i", self.attributes["dataWindow"])
        expect((x0, y0) == (0, 0), "window")
        self.width, self.height = x1 + 1, y1 + 1
        self.names = self._names(self.attributes["channels"])
        self.planes = {name: [] for name in self.names}
        chunks = (self.height + 15) // 16
        for offset in struct.unpack("<%dQ" % chunks, data[at + 1:at + 1 + 8 * chunks]):
            y, size = struct.unpack("<iI", data[offset:offset + 8])
            self._add(min(16, self.height - y), data[offset + 8:offset + 8 + size])

    @staticmethod
    def _names(text):
        names = []
        while text[0]:
            name, text = text.split(b"\0", 1)
            expect(struct.unpack("<I", text[:4])[0] == (0 if name[:3] == b"id." else 2), name, "has another type")
            names.append(name.decode())
            text = text[16:]
        return names

    def _add(self, rows, packed):
        size = rows * self.width * 4 * len(self.names)
        raw = packed if len(packed) == size else self._unpack(packed)
        for row in range(rows):
            for i, name in enumerate(self.names):
                start = 4 * (row * len(self.names) + i) * self.width
                kind = "<%d%s" % (self.width, "I" if name[:3] == "id." else "f")
                self.planes[name] += struct.unpack(kind, raw[start:start + 4 * self.width])

    @staticmethod
    def _unpack(packed):
        """Differences of bytes, the even ones before the odd ones."""
        raw, last, whole = zlib.decompress(packed), 0, bytearray()
        for i, byte in enumerate(raw):
            last = byte if i == 0 else (last + byte - 128) & 255
            whole.append(last)
        half, mixed = (len(whole) + 1) // 2, bytearray(len(whole))
        mixed[0::2], mixed[1::2] = whole[:half], whole[half:]
        return bytes(mixed)
