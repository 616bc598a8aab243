"""E57 files (ASTM E2807) that the command line's tests write."""
import struct

from check import crc32c

PAGE, DATA = 1024, 1020


def bits_of(field):
    if field["type"] == "Float":
        return 32 if field.get("precision") == "single" else 64
    return (field["maximum"] - field["minimum"]).bit_length()


def pack(field, values):
    """The stream of a field: the lowest bit first."""
    if not values:
        return b""
    if field["type"] == "Float":
        return struct.pack("<%d%s" % (len(values), "f" if field.get("precision") == "single" else "d"), *values)
    bits, whole = bits_of(field), 0
    for i, value in enumerate(values):
        whole |= (round((value - field.get("offset", 0)) / field.get("scale", 1)) - field["minimum"]) << (i * bits)
    return whole.to_bytes((len(values) * bits + 7) // 8, "little")


def e57(path, scans, most=500, damage=lambda whole: whole):
    """scans: (fields, rows, pose) each; a field is a dictionary of its name, type and attributes; pose is XML. Packets hold up to
    `most` bytes of each stream, the ones of later streams fewer."""
    place = lambda logical: logical // DATA * PAGE + logical % DATA
    body, xml = bytearray(48), ""
    for fields, rows, pose in scans:
        begin = len(body)
        body += bytes(32)
        streams = [pack(field, [row[i] for row in rows]) for i, field in enumerate(fields)]
        done = [0] * len(fields)
        while any(d < len(s) for d, s in zip(done, streams)):
            parts = [s[d:d + max(1, most - 7 * i)] for i, (d, s) in enumerate(zip(done, streams))]
            done = [d + len(p) for d, p in zip(done, parts)]
            packet = struct.pack("<H", len(fields)) + b"".join(struct.pack("<H", len(p)) for p in parts) + b"".join(parts)
            packet += bytes(-(len(packet) + 4) % 4)
            body += struct.pack("<BBH", 1, 0, len(packet) + 3) + packet
        struct.pack_into("<B7xQQQ", body, begin, 1, len(body) - begin, place(begin + 32), 0)
        lines = "".join('<%s type="%s"%s/>' % (f["name"], f["type"], "".join(' %s="%s"' % (k, v) for k, v in f.items() if k not in ("name", "type")))
                        for f in fields)
        xml += ('<vectorChild type="Structure">%s<points type="CompressedVector" fileOffset="%d" recordCount="%d"><prototype type="Structure">%s'
                '</prototype><codecs type="Vector"/></points></vectorChild>' % (pose, place(begin), len(rows), lines))
    text = ('<?xml version="1.0"?><e57Root type="Structure"><data3D type="Vector">%s</data3D><images2D type="Vector"/></e57Root>' % xml).encode()
    at = len(body)
    body += text
    pages = (len(body) + DATA - 1) // DATA
    body[:48] = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, pages * PAGE, place(at), len(text), PAGE)
    body += bytes(pages * DATA - len(body))
    whole = b"".join(body[i:i + DATA] + struct.pack(">I", crc32c(bytes(body[i:i + DATA]))) for i in range(0, len(body), DATA))
    with open(path, "wb") as file:
        file.write(damage(whole))
