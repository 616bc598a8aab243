#!/usr/bin/env python3
"""Programs in which one request for memory fails, each request in turn.

usage: allocations.py PROGRAMS SOURCE LIBRARY [--every N] [--only LABEL] [--jobs N] [--verbose]

PROGRAMS is the folder with isorender, isosculpt and isocompare, SOURCE the project's, LIBRARY the shared object of
fail_allocation.c, which is preloaded. Every command line runs once undisturbed, and then once for each of its requests,
which fails. It must either end as if nothing had happened, with status 0 and the same outputs, or with status 5, one
line on standard error, and nothing left behind. (The index of a volume, which a program that runs short of memory may
make to draw in chunks, is whole or not there, and may stay.)
"""
import argparse
import concurrent.futures
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile

SECONDS = 60


# ---- inputs

def write_volume(path, side):
    voxels = [128 + 60 * math.sin(x / 3) * math.cos(y / 4) + 50 * math.sin(z / 3) for z in range(side) for y in range(side)
              for x in range(side)]
    with open(path, "wb") as file:
        file.write(b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: %d %d %d\nspacings: 1 1 1\nencoding: raw\n\n" % (side, side, side))
        file.write(bytes(int(voxel) for voxel in voxels))


def write_inputs(folder, source, programs):
    def path(name):
        return os.path.join(folder, name)
    write_volume(path("v.nrrd"), 20)
    with open(path("cloud.xyz"), "w") as file:
        for i in range(400):
            z, turn = 1 - (2 * i + 1) / 400, i * 2.399963
            r = math.sqrt(1 - z * z)
            file.write("%f %f %f %f %f %f\n" % (*(10 * c for c in (r * math.cos(turn), r * math.sin(turn), z)),
                                                r * math.cos(turn), r * math.sin(turn), z))
    with open(path("cell.swc"), "w") as file:
        file.writelines("%d 3 %f %f %f 0.5 %d\n" % (i, i, 3 * math.sin(i), 3 * math.cos(i), i - 1 if i > 1 else -1)
                        for i in range(1, 30))
    with open(path("tetrahedron.stl"), "wb") as file:
        corners = [(0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)]
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        file.write(b"\0" * 80 + struct.pack("<I", len(faces)))
        for face in faces:
            file.write(struct.pack("<12fH", 0, 0, 0, *(c for corner in face for c in corners[corner]), 0))
    shutil.copy(os.path.join(source, "tests/hostile/ball.strokes"), path("ball.strokes"))
    with open(os.path.join(source, "tests/fuzz/corpus/glyphs/layered.laz"), "rb") as file, open(path("scan.laz"), "wb") as copy:
        copy.write(file.read()[1:])
    for name, isovalue in (("a.png", 120), ("b.png", 130)):
        subprocess.run([os.path.join(programs, "isorender"), path("v.nrrd"), path(name), "--isovalue=%d" % isovalue,
                        "--resolution=64x48", "--quiet"], check=True)


# ---- command lines: outputs are in the working directory, inputs in in/

SMALL = ["--resolution=64x48", "--threads=1", "--quiet", "--backend=cpu"]  # (drivers of OpenGL abort without memory)
# --aov is not among them: exr_add_part of OpenEXR 3.1 crashes when either of two of its requests fails, and a chunk for whose
# compression zlib gets no memory is stored uncompressed, so the file's bytes differ but not its values.
COMMANDS = {
    "scene": ["isorender", "scene:ct:32", "a.png", *SMALL],
    "volume": ["isorender", "in/v.nrrd", "a.png", "--orthographic", "--scale-bar", "--samples=4", *SMALL],
    "files": ["isorender", "in/v.nrrd", "a.png", "--isovalue=120", "--mesh=a.ply", "--points=p.ply", "--json=a.json", *SMALL],
    "turntable": ["isorender", "in/v.nrrd", "--isovalue=120", "--turntable=2", "--output=a{n}.png", *SMALL],
    "discs": ["isorender", "in/v.nrrd", "a.png", "--isovalue=120", "--method=discs", *SMALL],
    "pullpush": ["isorender", "in/v.nrrd", "a.png", "--isovalue=120", "--method=pullpush", "--lines=in/cell.swc",
                 "--surface=in/tetrahedron.stl", *SMALL],
    "layers": ["isorender", "in/v.nrrd", "a.png", "--isovalue=110,140", "--opacity=0.5", "--largest", "--closed", *SMALL],
    "part": ["isorender", "in/v.nrrd", "a.isokeys", "--part=1/2", "--chunk-size=16", *SMALL],
    "cloud": ["isorender", "in/cloud.xyz", "a.png", *SMALL],
    "laz": ["isorender", "in/scan.laz", "a.png", *SMALL],
    "lines": ["isorender", "in/cell.swc", "a.png", *SMALL],
    "info": ["isorender", "in/v.nrrd", "--info", "--threads=1"],
    "sculpt": ["isosculpt", "--replay", "in/ball.strokes", "--headless", "--output=a.ply", "--threads=1", "--quiet"],
    "images": ["isocompare", "images", "in/a.png", "in/b.png", "--threads=1"],
}


class Result:
    """What a run left: status, standard output, and the bytes of every file."""

    def __init__(self, command, inputs, programs, environment):
        with tempfile.TemporaryDirectory(prefix="allocations") as folder:
            work, temporary = os.path.join(folder, "work"), os.path.join(folder, "tmp")
            os.mkdir(work)
            os.mkdir(temporary)
            shutil.copytree(inputs, os.path.join(work, "in"))
            try:
                done = subprocess.run([os.path.join(programs, command[0]), *command[1:]], cwd=work, capture_output=True,
                                      stdin=subprocess.DEVNULL, timeout=SECONDS,
                                      env={**os.environ, "TMPDIR": temporary, "LC_ALL": "C", **environment})
                self.status, self.stdout, self.stderr = done.returncode, done.stdout, done.stderr
            except subprocess.TimeoutExpired:
                self.status, self.stdout, self.stderr = "no end", b"", b""
            self.files = {}
            for top in (work, temporary):
                for at, _, names in os.walk(top):
                    for name in names:
                        if name.endswith(".isoindex"):
                            continue
                        with open(os.path.join(at, name), "rb") as file:
                            self.files[os.path.relpath(os.path.join(at, name), folder)] = file.read()

    def outputs(self):
        """Reports hold times: they only have to be whole."""
        for name in self.files:
            if name.endswith(".json"):
                json.loads(self.files[name])
        return {name: "" if name.endswith(".json") else data for name, data in self.files.items()}


def find_fault(result, undisturbed, inputs):
    """What is wrong with a run of which a request failed; None: nothing."""
    if result.status == 0:
        if result.stdout != undisturbed.stdout:
            return "other standard output with status 0"
        mine, right = result.outputs(), undisturbed.outputs()
        missing = sorted(set(right) - set(mine))
        if missing:
            return "status 0 without " + ", ".join(missing)
        changed = sorted(name for name in mine if mine[name] != right.get(name))
        return "status 0 with other " + ", ".join(changed) if changed else None
    if result.status != 5:
        return "status %s" % result.status
    lines = result.stderr.decode(errors="replace").splitlines()
    if len(lines) != 1 or not lines[0].strip():
        return "%d lines with status 5" % len(lines)
    left = sorted(set(result.files) - {os.path.join("work", "in", name) for name in inputs})
    return "left behind: " + ", ".join(left) if left else None


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("programs")
    parser.add_argument("source")
    parser.add_argument("library")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--only")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    programs, library = os.path.abspath(options.programs), os.path.abspath(options.library)
    faults = cases = 0
    with tempfile.TemporaryDirectory(prefix="allocations") as folder:
        inputs, counted = os.path.join(folder, "in"), os.path.join(folder, "count")
        os.mkdir(inputs)
        write_inputs(inputs, options.source, programs)
        names = os.listdir(inputs)
        for label, command in COMMANDS.items():
            if options.only and label not in options.only.split(","):
                continue
            preload = {"LD_PRELOAD": library}
            undisturbed = Result(command, inputs, programs, {**preload, "FAIL_ALLOCATION_COUNT": counted})
            if undisturbed.status != 0:
                sys.exit("allocations.py: %s: status %s without a failure: %s" %
                         (" ".join(command), undisturbed.status, undisturbed.stderr))
            with open(counted) as file:
                requests = int(file.read())
            turns = range(1 + (len(label) % options.every), requests + 1, options.every)
            with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
                results = pool.map(lambda at: Result(command, inputs, programs, {**preload, "FAIL_ALLOCATION_AT": str(at)}), turns)
                for at, result in zip(turns, results):
                    cases += 1
                    fault = find_fault(result, undisturbed, names)
                    if fault:
                        faults += 1
                        said = result.stderr.decode(errors="replace").strip().replace("\n", " / ")
                        print("%s, request %d of %d: %s: %s" % (label, at, requests, fault, said), flush=True)
            if options.verbose:
                print("%s: %d requests" % (label, requests), flush=True)
    print("allocations.py: %d of %d cases wrong" % (faults, cases))
    sys.exit(faults != 0)


if __name__ == "__main__":
    main()
