# Writes stroke files with sound checksums: what a person could not have recorded, among it.
import json

from check import crc32c


def line(members):
    text = json.dumps(members, separators=(",", ":"))[:-1].encode()
    return text + b',"crc":"%08x"}\n' % crc32c(text)


def header(**changes):
    members = {"format": "isopoint strokes", "version": 1, "source": "ball", "source_crc": 0, "voxel_size": 2.0,
               "dims": [64, 64, 64], "origin": [-63.0] * 3, "radius": 23.0, "isovalue": 0.0}
    return {**members, **changes}


def brush(**changes):
    members = {"tool": "add", "shape": "sphere", "falloff": "smooth", "radius": 8.0, "strength": 1.0, "aspect": 0.0,
               "blend": 0.0, "spacing": 0.0, "symmetry": 0, "mirror": [0.0] * 3, "pressure_radius": False,
               "pressure_strength": False}
    return {**members, **changes}


def sample(event="sample", **changes):
    return {"event": event, "at": [20.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "pressure": 1.0, "t": 0.1, **changes}


def begin(sample_changes=None, **changes):
    return sample("begin", brush=brush(**changes), **(sample_changes or {}))


def write(path, events, head=None):
    lines = [line(head or header())]
    for number, event in enumerate(events):
        lines.append(line({"n": number, **event}))
    with open(path, "wb") as file:
        file.write(b"".join(lines))
