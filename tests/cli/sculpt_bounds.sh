# every number of a stroke file is bounded: what lies outside is refused at once, with status 3 and one line that names
# the file, its line and the number; nothing is written
cat > in/cases.py <<'P'
from strokes import *
end = {"event": "end"}
far = [1e9, 0.0, 0.0]
cases = {
    # name: (header, events, line, words of the message)
    "radius_small": (None, [begin(radius=1e-30), sample(), end], 2, "radius 1e-30 mm"),
    "radius_large": (None, [begin(radius=1e6), end], 2, "radius 1e+06 mm"),
    "spacing": (None, [begin(spacing=1e-12), sample(at=[21, 0, 0]), end], 2, "spacing 1e-12"),
    "strength": (None, [begin(strength=1.5), end], 2, "strength 1.5"),
    "aspect": (None, [begin(aspect=11), end], 2, "aspect 11"),
    "blend": (None, [begin(blend=-1), end], 2, "blend -1"),
    "symmetry": (None, [begin(symmetry=8), end], 2, "symmetry 8"),
    "mirror": (None, [begin(mirror=[0, 1e300, 0]), end], 2, "mirror plane 1e+300 mm"),
    "tool": (None, [begin(tool="chisel"), end], 2, "'tool'"),
    "shape": (None, [begin(shape="heart"), end], 2, "'shape'"),
    "falloff": (None, [begin(falloff="steep"), end], 2, "'falloff'"),
    "position": (None, [begin(), sample(at=far), end], 3, "1e+09 mm"),
    "pressure": (None, [begin(), sample(pressure=-0.5), end], 3, "pressure -0.5"),
    "time": (None, [begin(), end, begin({"t": -1.0}), end], 4, "time -1 s"),
    "normal": (None, [begin({"normal": [0, 0, 1e9]}), end], 2, "component of a normal 1e+09"),
    "touches": (None, [begin(radius=0.05, spacing=0.01), sample(at=[1e6, 0, 0]), end], 3, "touches: at most"),
    "kind": (None, [begin(), {"event": "explode"}], 3, "'event'"),
    "number": (None, [{"n": 7, **begin()}, end], 2, "a line is missing"),
    "missing": (None, [{"event": "sample", "at": [0, 0, 0]}, end], 2, "'normal'"),
    "sample_first": (None, [sample(), end], 2, "no stroke"),
    "end_first": (None, [end, begin()], 2, "no stroke"),
    "begin_twice": (None, [begin(), begin(), end], 3, "a stroke is being drawn"),
    "undo_nothing": (None, [begin(), end, {"event": "undo"}, {"event": "undo"}, end], 5, "nothing to undo"),
    "redo_nothing": (None, [begin(), end, {"event": "redo"}], 4, "nothing to redo"),
    "undo_in_stroke": (None, [begin(), {"event": "undo"}], 3, "a stroke is being drawn"),
    "last_line": (None, [begin(), end, begin(radius=1e30)], 4, "radius 1e+30 mm"),
    "snapshot": (None, [{"event": "snapshot", "file": "x", "after": 9}, end], 2, "snapshot after 9"),
    "no_stamp": (None, [begin(shape="stamp"), end], 2, "stamp"),
    "stamp": (None, [{"event": "stamp", "name": "a", "levels": "AAAA"}, end], 2, "stamp"),
    "voxel_size": (header(voxel_size=-1.0), [], 1, "voxel size -1 mm"),
    "dims": (header(dims=[64, 64, 1 << 20]), [], 1, "1.04858e+06"),
    "dims_part": (header(dims=[64, 64, 60]), [], 1, "multiple of 16"),
    "origin": (header(origin=[0, 0, 1e300]), [], 1, "origin 1e+300 mm"),
    "ball": (header(radius=1e6), [], 1, "radius of the ball 1e+06 mm"),
    "isovalue": (header(isovalue=1e301), [], 1, "isovalue 1e+301"),
    "checksum": (header(source_crc=1 << 40), [], 1, "checksum of the source"),
}
import subprocess, os
for name, (head, events, where, words) in cases.items():
    path = "in/%s.strokes" % name
    write(path, events, head)
    done = subprocess.run(["isosculpt", "--replay", path, "--headless", "--output", "in/out.ply"], capture_output=True,
                          text=True, timeout=60)
    text = done.stderr
    good = done.returncode == 3 and text.count("\n") == 1 and path in text and "line %d:" % where in text and words in text
    assert good, (name, done.returncode, text)
    assert not os.path.exists("in/out.ply"), name
P
python3 in/cases.py
