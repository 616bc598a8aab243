"""What an edit of a past stroke costs after 10,000 strokes on a grid of 1024 voxels a side: writes a stroke file like that of a
person who works here and there on a large ball, and edits strokes anywhere in it.

past_strokes.py ISOSCULPT [STROKES [EDITS [THREADS]]]: prints how long edits take until there is a result (the first one, which
draws all strokes once more, apart), and the memory of the versions."""
import json
import math
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
import strokes

SIDE, RADIUS, SAMPLES = 1024, 400.0, 10
TOOLS = [("blend-add", 30), ("clay", 15), ("smooth", 25), ("inflate", 10), ("carve", 5), ("flatten", 5), ("pinch", 5), ("move", 5)]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def stroke(rng, centre):
    """A stroke within 80 voxels of a place on the ball; radii of 4 to 24 voxels, small ones as often as large ones."""
    tool = rng.choices([t for t, _ in TOOLS], [w for _, w in TOOLS])[0]
    radius = 4 * 6 ** rng.random()
    normal = unit([c + rng.uniform(-80, 80) / RADIUS for c in centre])
    step = [rng.uniform(-1, 1) * radius / SAMPLES * (0.5 if tool == "move" else 3) for _ in range(3)]
    events = []
    for i in range(SAMPLES):
        n = unit([normal[k] + i * step[k] / RADIUS for k in range(3)])
        at = [RADIUS * x for x in n]
        sample = {"at": at, "normal": n, "t": float(i)}
        events.append(strokes.sample(**sample) if i else strokes.begin(sample, tool=tool, radius=radius, strength=0.5))
    return events + [{"event": "end"}]


def write(path, count, rng):
    events = []
    for i in range(count):
        if i % 50 == 0:
            centre = unit([rng.gauss(0, 1) for _ in range(3)])
        events += stroke(rng, centre)
    head = strokes.header(voxel_size=1.0, dims=[SIDE] * 3, origin=[-(SIDE - 1) / 2] * 3, radius=RADIUS)
    strokes.write(path, events, head)


def edits(rng, count, number):
    for i in range(number):
        at = rng.randint(1, count)
        kind = i % 5
        if kind < 3:
            change = ["radius=%.3f" % (4 * 6 ** rng.random()), "strength=%.2f" % rng.uniform(0.2, 1), "falloff=linear"][kind]
            yield ["--edit", "%d:%s" % (at, change)]
        else:
            yield ["--mute", str(at)] if kind == 3 else ["--move", "%d:%d" % (at, min(count, at + 7) if at < count else 1)]


def main(program, count=10000, number=60, threads=0):
    rng = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        path, report = os.path.join(folder, "many.strokes"), os.path.join(folder, "report.json")
        write(path, count, rng)
        options = [word for edit in edits(rng, count, number) for word in edit]
        subprocess.run([program, "--replay", path, "--headless", "--quiet", "--json=" + report, "--threads", str(threads),
                        "--unmute", "1", *options], check=True)
        with open(report) as file:
            made = json.load(file)
    times = made["seconds"]["stroke_edit"]
    print("%d strokes, %d samples; a sample %.2f ms (p50)" % (made["strokes"], made["samples"], 1e3 * made["seconds"]["step"]["p50"]))
    print("first edit %.1f s; %d more: p50 %.0f ms, p95 %.0f ms" % (times["max"], times["count"] - 1, 1e3 * times["p50"], 1e3 * times["p95"]))
    print("versions %.0f MB; strokes drawn again %d" % (made["version_bytes"] / 1e6, made["strokes_drawn_again"]))


main(sys.argv[1], *map(int, sys.argv[2:]))
