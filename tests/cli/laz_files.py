"""LAS files and the same points in LAZ that the command line's tests write: an encoder of both ways of compression, the mirror of
src/io/glyphs/laz_*.c. Records are bytes, as in a LAS file."""
import struct

MASK, LEAST = 0xFFFFFFFF, 1 << 24


class Model:
    def __init__(self, symbols):
        self.counts, self.total, self.cycle = [1] * symbols, 0, symbols
        self.renew()
        self.cycle = self.left = (symbols + 6) // 2

    def renew(self):
        self.total += self.cycle
        if self.total > 1 << 15:
            self.counts = [(c + 1) // 2 for c in self.counts]
            self.total = sum(self.counts)
        scale, total, self.begins = (1 << 31) // self.total, 0, []
        for count in self.counts:
            self.begins.append(scale * total >> 16)
            total += count
        self.cycle = self.left = min(5 * self.cycle // 4, 8 * (len(self.counts) + 6))


class Encoder:
    def __init__(self):
        self.out, self.base, self.length, self.models = bytearray(), 0, MASK, {}

    def narrow(self, begin, length):
        self.base += begin
        self.length = length
        self.carry()
        while self.length < LEAST:
            self.out.append(self.base >> 24)
            self.base, self.length = self.base << 8 & MASK, self.length << 8

    def carry(self):
        if self.base <= MASK:
            return
        self.base &= MASK
        at = len(self.out) - 1
        while self.out[at] == 255:
            self.out[at] = 0
            at -= 1
        self.out[at] += 1

    def symbol(self, name, symbols, symbol):
        m = self.models.get(name) or self.models.setdefault(name, Model(symbols))
        unit = self.length >> 15
        begin = m.begins[symbol] * unit
        self.narrow(begin, (m.begins[symbol + 1] * unit if symbol + 1 < symbols else self.length) - begin)
        m.counts[symbol] += 1
        m.left -= 1
        if m.left == 0:
            m.renew()

    def bit(self, name, bit):
        m = self.models.setdefault(name, [4096, 1, 2, 4, 4])  # interval and number of zeros, of all, cycle, left
        part = m[0] * (self.length >> 13)
        self.narrow(part if bit else 0, self.length - part if bit else part)
        m[1] += not bit
        m[4] -= 1
        if m[4]:
            return
        m[2] += m[3]
        if m[2] > 8192:
            m[2], m[1] = (m[2] + 1) // 2, (m[1] + 1) // 2
            m[2] += m[1] == m[2]
        m[0], m[3] = m[1] * ((1 << 31) // m[2]) >> 18, min(5 * m[3] // 4, 64)
        m[4] = m[3]

    def raw(self, bits, number):
        if bits > 19:
            self.raw(16, number & 0xFFFF)
            bits, number = bits - 16, number >> 16
        self.narrow(number * (self.length >> bits), self.length >> bits)

    def integer(self, name, bits, predicted, number, context=0):
        """Returns the size of the difference."""
        half = 1 << (bits - 1)
        c = (number - predicted + half) % (2 * half) - half
        k = (-c if c <= 0 else c - 1).bit_length()
        self.symbol((name, context), bits + 1, k)
        if k == 0:
            self.bit((name, "bit"), c)
        elif k < 32:
            c = c + (1 << k) - 1 if c < 0 else c - 1
            self.symbol((name, "high", k), 1 << min(k, 8), c >> max(k - 8, 0))
            if k > 8:
                self.raw(k - 8, c & (1 << (k - 8)) - 1)
        return k

    def done(self):
        long = self.length > 2 * LEAST
        self.narrow(LEAST if long else LEAST >> 1, LEAST >> 1 if long else LEAST >> 9)
        return bytes(self.out) + bytes(3 if long else 2)


class Median:
    def __init__(self):
        self.sorted, self.drop_smallest = [0] * 5, False

    def add(self, number):
        before = self.sorted[2]
        del self.sorted[0 if self.drop_smallest else 4]
        self.sorted = sorted(self.sorted + [number])
        self.drop_smallest = before < number if self.drop_smallest else number >= before


def signed(number, bits=32):
    return (number + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1)


class Time:
    MOST, LEAST, SAME, FULL = 500, 510, 511, 512

    def __init__(self, coder, first, layered, name=()):
        self.coder, self.layered, self.name = coder, layered, name
        self.times, self.steps, self.extremes, self.last, self.newest = [first, 0, 0, 0], [0] * 4, [0] * 4, 0, 0

    def near(self, i, time):
        return -(1 << 31) <= time - self.times[i] < 1 << 31

    def code(self, zero, code):
        less = self.layered and (zero or code > self.SAME)
        self.coder.symbol((self.name, "zero" if zero else "multiple"), (6 if zero else 516) - self.layered, code - less)

    def integer(self, predicted, number, context):
        self.coder.integer((self.name, "time"), 32, predicted, number, context)

    def full(self, zero, time):
        other = next((k for k in (1, 2, 3) if self.near(self.last + k & 3, time)), 0)
        self.code(zero, (2 if zero else self.FULL) + other)
        if other:
            self.last = self.last + other & 3
            return self.write(time)
        self.newest = self.newest + 1 & 3
        self.integer(self.times[self.last] >> 32, time >> 32, 8)
        self.coder.raw(32, time & MASK)
        self.last = self.newest
        self.times[self.last], self.steps[self.last], self.extremes[self.last] = time, 0, 0

    def write(self, time):
        i = self.last
        step, difference = self.steps[i], time - self.times[i]
        if difference == 0 and not self.layered:
            return self.code(step == 0, 0 if step == 0 else self.SAME)
        if not self.near(i, time):
            return self.full(step == 0, time)
        self.times[i] = time
        if step == 0:
            self.code(True, 1)
            self.integer(0, difference, 0)
            self.steps[i], self.extremes[i] = difference, 0
            return
        multiple = max(-10, min(self.MOST, int(difference / step + (0.5 if difference / step > 0 else -0.5))))
        context = {0: 7, 1: 1, self.MOST: 4, -10: 6}.get(multiple, 5 if multiple < 0 else 2 if multiple < 10 else 3)
        self.code(False, multiple if multiple >= 0 else self.MOST - multiple)
        self.integer(multiple * step, difference, context)
        if multiple == 1:
            self.extremes[i] = 0
        if multiple in (0, self.MOST, -10):
            self.extremes[i] += 1
            if self.extremes[i] > 3:
                self.steps[i], self.extremes[i] = difference, 0


def write_color(coder, name, last, now):
    a, b = [list(struct.pack("<3H", *c)) for c in (last, now)]
    gray = b[:2] == b[2:4] == b[4:]
    used = sum((x != y) << k for k, (x, y) in enumerate(zip(a, b))) if not gray else (a[0] != b[0]) | (a[1] != b[1]) << 1
    coder.symbol((name, "used"), 128, used | (not gray) << 6)
    clamp = lambda n: max(0, min(255, n))
    for i in (0, 1):
        if used >> i & 1:
            coder.symbol((name, i), 256, (b[i] - a[i]) % 256)
    for i in (0, 1):
        red = b[i] - a[i]
        if used >> (2 + i) & 1:
            coder.symbol((name, 2 + i), 256, (b[2 + i] - clamp(red + a[2 + i])) % 256)
        if used >> (4 + i) & 1:
            both = int((red + b[2 + i] - a[2 + i]) / 2)
            coder.symbol((name, 4 + i), 256, (b[4 + i] - clamp(both + a[4 + i])) % 256)


def write_xyz(state, xy, z_coder, name, last, now, steps, level, single):
    """Writes where a point is; state has the medians and heights of its kinds of returns."""
    sizes = []
    for axis in (0, 1):
        median, number = state.setdefault((axis, steps), Median()), signed(now[axis] - last[axis])
        context = single + (min(sizes[0] & ~1, 20) if axis else 0)
        sizes.append(xy.integer((name, axis), 32, median.sorted[2], number, context))
        median.add(number)
    size = sum(sizes) // 2
    z_coder.integer((name, 2), 32, state.get(level, state["z"]), now[2], single + min(size & ~1, 18))
    state[level] = now[2]


def write_wave(coder, state, a, b):
    coder.symbol("descriptor", 256, b[0])
    (offset, size, *rest), (now, *now_rest) = struct.unpack("<Q5i", a[1:]), struct.unpack("<Q5i", b[1:])
    size, near = size % (1 << 32), -(1 << 31) <= now - offset < 1 << 31
    how = 0 if now == offset else 1 if now == offset + size else 2 if near else 3
    coder.symbol(("offset", state.get("how", 0)), 4, how)
    state["how"] = how
    if how == 2:
        coder.integer("offset step", 32, state.get("offset step", 0), now - offset)
        state["offset step"] = now - offset
    if how == 3:
        coder.raw(32, now & MASK)
        coder.raw(32, now >> 32)
    coder.integer("size", 32, size, now_rest[0])
    coder.integer("place", 32, rest[0], now_rest[1])
    for axis in range(3):
        coder.integer("direction", 32, rest[1 + axis], now_rest[2 + axis], axis)


def write_point1(coder, state, a, b):
    last, now = struct.unpack_from("<3i", a), struct.unpack_from("<3i", b)
    steps, sizes = state.setdefault("steps", [(0, 0)] * 3), []
    for axis in (0, 1):
        median = sorted(s[axis] for s in steps)[1]
        sizes.append(coder.integer(axis, 32, median, signed(now[axis] - last[axis]), min(sizes[0], 19) if axis else 0))
    steps.append(tuple(signed(now[axis] - last[axis]) for axis in (0, 1)))
    del steps[0]
    size = sum(sizes) // 2
    coder.integer(2, 32, last[2], now[2], min(size, 19))
    changed = [a[12:14] != b[12:14]] + [a[k] != b[k] for k in (14, 15, 17)] + [a[18:] != b[18:]]
    changed.insert(3, a[16] != b[16])
    coder.symbol("changed", 64, sum(c << (5 - k) for k, c in enumerate(changed)))
    if changed[0]:
        coder.integer("intensity", 16, a[12] | a[13] << 8, b[12] | b[13] << 8)
    for k, at in ((1, 14), (2, 15), (3, 16), (4, 17)):
        if changed[k] and at == 16:
            coder.integer("angle", 8, a[16], b[16], size < 3)
        elif changed[k]:
            coder.symbol((at, a[at]), 256, b[at])
    if changed[5]:
        coder.integer("source", 16, a[18] | a[19] << 8, b[18] | b[19] << 8)


def write_time1(coder, state, a, b):
    last, now = int.from_bytes(a, "little"), int.from_bytes(b, "little")
    step, difference, near = state.get("step", 0), now - last, -(1 << 31) <= now - last < 1 << 31
    if step == 0:
        coder.symbol("zero", 3, 0 if difference == 0 else 1 if near else 2)
    elif difference == 0 or not near:
        coder.symbol("multiple", 512, 511 if difference == 0 else 510)
    if not near:
        coder.raw(32, now & MASK)
        coder.raw(32, now >> 32)
    if difference == 0 or not near:
        return
    if step == 0:
        coder.integer("time", 32, 0, difference)
        state["step"] = difference
        return
    multiple = max(0, min(509, int(difference / step + 0.5)))
    coder.symbol("multiple", 512, multiple)
    context = 2 if multiple == 0 else 1 if multiple == 1 else 3 if multiple < 10 else 4 if multiple < 50 else 5
    coder.integer("time", 32, int(step / 4) if multiple == 0 else multiple * step, difference, context)
    state["extremes"] = state.get("extremes", 0) + (multiple in (0, 509))
    if multiple == 1 or state["extremes"] > 3:
        state["step"], state["extremes"] = difference, 0


def version1_chunk(records, items):
    """As LASzip wrote until 2011."""
    coder, states = Encoder(), {kind: {} for kind, _ in items}
    for last, record in zip(records, records[1:]):
        at = 0
        for kind, size in items:
            a, b = last[at:at + size], record[at:at + size]
            if kind in (6, 7, 9):
                {6: write_point1, 7: write_time1, 9: write_wave}[kind](coder, states[kind], a, b)
            if kind == 8:
                coder.symbol("used", 64, sum((x != y) << k for k, (x, y) in enumerate(zip(a, b))))
            for k in range(size if kind in (0, 8) else 0):
                if kind == 0 or a[k] != b[k]:
                    coder.integer("bytes" if kind == 0 else "rgb", 8, a[k], b[k], k)
            at += size
    return records[0] + coder.done()


def pointwise_chunk(records, items):
    contexts = ((15, 14, 13, 12, 11, 10, 9, 8), (14, 0, 1, 3, 6, 10, 10, 9), (13, 1, 2, 4, 7, 11, 11, 10), (12, 3, 4, 5, 8, 12, 12, 11),
                (11, 6, 7, 8, 9, 13, 13, 12), (10, 10, 11, 12, 13, 14, 14, 13), (9, 10, 11, 12, 13, 14, 15, 14), (8, 9, 10, 11, 12, 13, 14, 15))
    coder, state, intensities, last, time = Encoder(), {"z": 0}, [0] * 16, records[0], None
    for record in records[1:]:
        at = 0
        for kind, size in items:
            a, b = last[at:at + size], record[at:at + size]
            if kind == 6:
                flags, intensity = b[14], b[12] | b[13] << 8
                number, returns = flags & 7, flags >> 3 & 7
                m = contexts[returns][number]
                changed = [a[14] != flags, intensities[m] != intensity] + [a[k] != b[k] for k in (15, 16, 17)] + [a[18:] != b[18:]]
                coder.symbol("changed", 64, sum(c << (5 - k) for k, c in enumerate(changed)))
                if changed[0]:
                    coder.symbol(("flags", a[14]), 256, flags)
                if changed[1]:
                    coder.integer("intensity", 16, intensities[m], intensity, min(m, 3))
                    intensities[m] = intensity
                if changed[2]:
                    coder.symbol(("class", a[15]), 256, b[15])
                if changed[3]:
                    coder.symbol(("angle", flags >> 6 & 1), 256, (b[16] - a[16]) % 256)
                if changed[4]:
                    coder.symbol(("user", a[17]), 256, b[17])
                if changed[5]:
                    coder.integer("source", 16, a[18] | a[19] << 8, b[18] | b[19] << 8)
                write_xyz(state, coder, coder, "xyz", struct.unpack_from("<3i", a), struct.unpack_from("<3i", b), m,
                          ("level", abs(returns - number)), returns == 1)
            elif kind == 7:
                time = time or Time(coder, int.from_bytes(records[0][at:at + 8], "little"), False)
                time.write(int.from_bytes(b, "little"))
            elif kind == 8:
                write_color(coder, "rgb", struct.unpack("<3H", a), struct.unpack("<3H", b))
            elif kind == 9:
                write_wave(coder, state, a, b)
            else:
                for k in range(size):
                    coder.symbol(("byte", k), 256, (b[k] - a[k]) % 256)
            at += size
        last = record
    return records[0] + coder.done()


def return_context(returns, number):
    """Of a point of format 6 and later: 6 kinds."""
    rows = """0123453445555555 1013333333333333 2124444444433333 3345444444444444 4344544444444444 5344454444444444 3344445444444444
    4344444544444444 4344444454444444 5344444445444444 5344444444544444 5334444444455444 5334444444455544 5334444444445554
    5334444444444555 5334444444444455""".split()
    return int(rows[returns][number])


def unpack14(b):
    x, y, z, intensity, returns, flags, kind, user, angle, source, time = struct.unpack("<3iHBBBBhHQ", b)
    return {"xyz": (x, y, z), "intensity": intensity, "number": returns & 15, "returns": returns >> 4, "class": kind, "user": user,
            "flags": flags & 15 | flags >> 2 & 48, "channel": flags >> 4 & 3, "angle": angle, "source": source, "time": time}


class Layer:
    """A coder whose bytes are left out if what it codes never changed."""
    def __init__(self):
        self.coder, self.used = Encoder(), False

    def bytes(self):
        return self.coder.done() if self.used else b""


def layered_chunk(records, items, version):
    names = ("xy", "z", "class", "flags", "intensity", "angle", "user", "source", "time")
    layers = {name: Layer() for name in names}
    layers["xy"].used = True
    xy = layers["xy"].coder
    first = unpack14(records[0][:30])
    channels, current = {}, first["channel"]

    def begin(c, last):
        state = {"last": dict(last, channel=c), "time_changed": False, "state": {"z": last["xyz"][2]}, "intensities": [last["intensity"]] * 8}
        state["time"] = Time(layers["time"].coder, last["time"], True, c)
        channels[c] = state

    begin(current, first)
    others, at = [], 30  # of each other item: what each channel has last, and the channel
    for kind, size in items[1:]:
        extra = 1 if kind == 11 else 2 if kind == 12 else size if kind == 14 else 1
        others.append({"kind": kind, "at": at, "size": size, "last": {current: records[0][at:at + size]}, "current": current,
                       "layers": [Layer() for _ in range(extra)]})
        at += size
    for record in records[1:]:
        p, c = unpack14(record[:30]), channels[current]
        last, before = c["last"], current
        context = (last["number"] == 1) | (last["number"] >= last["returns"]) << 1 | c["time_changed"] << 2
        current = p["channel"]
        if current not in channels:
            begin(current, last)
        next_c = channels[current]
        q = next_c["last"]
        time_changed = p["time"] != q["time"]
        turn = (p["number"] - q["number"]) % 16
        how = {0: 0, 1: 1, 15: 2}.get(turn, 3)
        changed = (how | (p["returns"] != q["returns"]) << 2 | (p["angle"] != q["angle"]) << 3 | time_changed << 4
                   | (p["source"] != q["source"]) << 5 | (current != before) << 6)
        xy.symbol((before, "changed", context), 128, changed)
        if current != before:
            xy.symbol((before, "channel"), 3, (current - before) % 4 - 1)
        if changed & 4:
            xy.symbol((current, "returns", q["returns"]), 16, p["returns"])
        if how == 3 and time_changed:
            xy.symbol((current, "number", q["number"]), 16, p["number"])
        elif how == 3:
            xy.symbol((current, "same time"), 13, turn - 2)
        for name in ("class", "flags", "intensity", "angle", "user", "source"):
            layers[name].used |= p[name] != q[name]
        layers["z"].used |= p["xyz"][2] != q["xyz"][2]
        layers["time"].used |= time_changed
        write_xyz(next_c["state"], xy, layers["z"].coder, current, q["xyz"], p["xyz"],
                  2 * return_context(p["returns"], p["number"]) + time_changed, ("level", min(7, abs(p["returns"] - p["number"]))), p["returns"] == 1)
        beam = (p["number"] == 1) << 1 | (p["number"] >= p["returns"])
        layers["class"].coder.symbol((current, (q["class"] & 31) << 1 | (beam == 3)), 256, p["class"])
        layers["flags"].coder.symbol((current, q["flags"]), 64, p["flags"])
        layers["intensity"].coder.integer(current, 16, next_c["intensities"][beam << 1 | time_changed], p["intensity"], beam)
        next_c["intensities"][beam << 1 | time_changed] = p["intensity"]
        if changed & 8:
            layers["angle"].coder.integer(current, 16, q["angle"], p["angle"], time_changed)
        layers["user"].coder.symbol((current, q["user"] // 4), 256, p["user"])
        if changed & 32:
            layers["source"].coder.integer(current, 16, q["source"], p["source"])
        if time_changed:
            next_c["time"].write(p["time"])
        next_c["last"], next_c["time_changed"] = p, time_changed
        known = current if current != before or version >= 4 else 0
        for o in others:
            begins, was = known not in o["last"], o["current"]
            if begins:
                o["last"][known] = o["last"][was]
            o["current"] = known
            place = was if version < 4 and not begins else known
            a, b = o["last"][place], record[o["at"]:o["at"] + o["size"]]
            o["last"][place] = b
            if o["kind"] in (11, 12):
                o["layers"][0].used |= a[:6] != b[:6]
                write_color(o["layers"][0].coder, known, struct.unpack("<3H", a[:6]), struct.unpack("<3H", b[:6]))
            if o["kind"] == 12:
                layer = o["layers"][1]
                layer.used |= a[6:] != b[6:]
                layer.coder.symbol((known, "used"), 4, (a[6] != b[6]) | (a[7] != b[7]) << 1)
                for k in (6, 7):
                    if a[k] != b[k]:
                        layer.coder.symbol((known, k), 256, (b[k] - a[k]) % 256)
            if o["kind"] == 14:
                for k, layer in enumerate(o["layers"]):
                    layer.used |= a[k] != b[k]
                    layer.coder.symbol(known, 256, (b[k] - a[k]) % 256)
    parts = [layers[name].bytes() for name in names] + [layer.bytes() for o in others for layer in o["layers"]]
    return records[0] + struct.pack("<I", len(records)) + b"".join(struct.pack("<I", len(p)) for p in parts) + b"".join(parts)


# ---- files

FORMATS = {0: (6,), 1: (6, 7), 2: (6, 8), 3: (6, 7, 8), 4: (6, 7, 9), 5: (6, 7, 8, 9), 6: (10,), 7: (10, 11), 8: (10, 12), 9: (10, 13)}
SIZES = {6: 20, 7: 8, 8: 6, 9: 29, 10: 30, 11: 6, 12: 8, 13: 29}


def file(point_format, records, blocks, scale, compressed):
    minor = 4 if point_format >= 6 else 2
    head = bytearray(375 if minor == 4 else 227)
    head[0:4], head[24], head[25] = b"LASF", 1, minor
    body = b"".join(struct.pack("<H16sHH32s", 0, user, number, len(b), b"") + b for user, number, b in blocks)
    struct.pack_into("<HIIBHI", head, 94, len(head), len(head) + len(body), len(blocks), point_format | 128 * compressed,
                     len(records[0]), 0 if minor == 4 else len(records))
    struct.pack_into("<6d", head, 131, scale, scale, scale, 0, 0, 0)
    if minor == 4:
        struct.pack_into("<Q", head, 247, len(records))
    return bytes(head) + body


def las(path, point_format, records, scale=0.01, blocks=()):
    open(path, "wb").write(file(point_format, records, list(blocks), scale, False) + b"".join(records))


def laz(path, point_format, records, chunks, scale=0.01, blocks=(), version=3, table_at_end=False, behind=b"", damage=lambda whole: whole):
    """chunks: points of every chunk, or a list with those of each. version: of items, 1 in a single chunk as LASzip 1 wrote it. behind: what follows each chunk."""
    layered, varies, first = point_format >= 6, isinstance(chunks, list), version == 1
    items = [(kind, SIZES[kind]) for kind in FORMATS[point_format]]
    extra = len(records[0]) - sum(size for _, size in items)
    if extra:
        items.append((14 if layered else 0, extra))
    counts = chunks if varies else [min(chunks, len(records) - k) for k in range(0, len(records), chunks)]
    parts, at = [], 0
    for count in counts:
        some = records[at:at + count]
        part = layered_chunk(some, items, version) if layered else (version1_chunk if first else pointwise_chunk)(some, items)
        parts.append(part + behind)
        at += count
    block = struct.pack("<HHBBHIIqqH", 3 if layered else 1 if first else 2, 0, 3, 4, 3, 0, MASK if varies else chunks, -1, -1, len(items))
    block += b"".join(struct.pack("<3H", kind, size, version if layered else 1 if first or kind == 9 else 2) for kind, size in items)
    head = file(point_format, records, [*blocks, (b"laszip encoded", 22204, block)], scale, True)
    if first:
        open(path, "wb").write(head + parts[0])
        return
    coder, last = Encoder(), (0, 0)
    for count, part in zip(counts, parts):
        if varies:
            coder.integer("table", 32, last[0], count, 0)
        coder.integer("table", 32, last[1], len(part), 1)
        last = (count, len(part))
    table = len(head) + 8 + sum(map(len, parts))
    whole = head + struct.pack("<q", -1 if table_at_end else table) + b"".join(parts) + struct.pack("<II", 0, len(parts)) + coder.done()
    open(path, "wb").write(damage(whole + (struct.pack("<q", table) if table_at_end else b"")))
