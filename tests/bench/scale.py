#!/usr/bin/env python3
"""scale.py BIN [--paraview ROOT] [--side 512] [--ranks 1,2,4] [--runs 3] [--json FILE]: the same isosurface by isorender
alone, by isorender under mpirun, and by ParaView's pvbatch with IceT under mpirun.

Times are of whole processes, from the file to the PNG: the median of the runs, which are interleaved. Processor seconds are user
and system of all ranks, and depend less on what else the machine does. Peak: the largest resident memory of a rank. Pixels
that differ: from the first picture by the same program, whose view is its own default. pvbatch sometimes ends by a signal when it
starts: it is then started again, and the table says how often it failed."""
import argparse
import glob
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from check import Png  # noqa: E402

PERIOD = 64
ISOVALUE = "120.5"
PVBATCH = """
import sys
from paraview.simple import *
path, side, isovalue, picture, width = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), sys.argv[4], int(sys.argv[5])
reader = ImageReader(FileNames=[path], DataScalarType='unsigned char', FileDimensionality=3, DataExtent=[0, side - 1] * 3,
                     DataByteOrder='LittleEndian')
surface = Contour(Input=reader, ContourBy=['POINTS', 'ImageFile'], Isosurfaces=[isovalue], ComputeNormals=1)
view = CreateView('RenderView')
view.ViewSize = [width, width]
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
ColorBy(Show(surface, view), None)
ResetCamera(view)
SaveScreenshot(picture, view, ImageResolution=[width, width])
"""


def write_waves(path, side):
    """Waves of a period of 64 voxels along y and z: few rows are computed, and written many times."""
    from math import cos, pi, sin
    turn = 2 * pi / PERIOD
    rows = [[bytes(max(0, min(255, int(120 + 70 * sin(x / 17) * cos(y * turn) + 50 * sin(z * turn + x / 41)))) for x in range(side))
             for y in range(PERIOD)] for z in range(PERIOD)]
    with open(path, "wb") as file:
        for z in range(side):
            file.write(b"".join(rows[z % PERIOD][y % PERIOD] for y in range(side)))


def as_rank(folder, command):
    """Runs one rank, and leaves a file that says how much memory it took."""
    status = subprocess.call(command)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    with open(os.path.join(folder, "peak.%d" % os.getpid()), "w", encoding="utf-8") as file:
        file.write(str(peak))
    return status


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Program:
    def __init__(self, name, ranks, command, environment):
        self.name, self.ranks, self.command, self.environment = name, ranks, command, environment
        self.seconds, self.processor, self.peak, self.picture, self.failed = [], [], 0, None, 0

    def run(self, folder):
        """Runs the program; pvbatch up to three times, until it succeeds."""
        attempts = 3 if "pvbatch" in self.name else 1
        while not self.attempt(folder, attempts == 1):
            attempts -= 1
            self.failed += 1

    def attempt(self, folder, is_last):
        picture = os.path.join(folder, "%s-%d.png" % (self.name.replace(" ", "-"), self.ranks))
        measured = [sys.executable, os.path.abspath(__file__), "--rank", folder, "--", *self.command(picture)]
        start = ["mpirun", "--oversubscribe", "-n", str(self.ranks)] if "mpirun" in self.name else []
        before, began = processor_seconds(), time.monotonic()
        done = subprocess.run(start + measured, env={**os.environ, **self.environment}, capture_output=True, text=True, check=False)
        seconds, processor = time.monotonic() - began, processor_seconds() - before
        if done.returncode and is_last:
            sys.exit("%s, %d ranks: exit status %d: %s" % (self.name, self.ranks, done.returncode, done.stderr[-2000:]))
        if done.returncode:
            return False
        self.seconds.append(seconds)
        self.processor.append(processor)
        for name in [name for name in os.listdir(folder) if name.startswith("peak.")]:
            self.peak = max(self.peak, int(open(os.path.join(folder, name), encoding="utf-8").read()))
            os.remove(os.path.join(folder, name))
        self.picture = Png(picture).rows
        return True


def median(values):
    return sorted(values)[len(values) // 2]


def differing(picture, other):
    return sum(a != b for row, theirs in zip(picture, other) for a, b in zip(row, theirs))


def list_programs(options, volume):
    pictures = ["--isovalue", ISOVALUE, "--resolution", "%dx%d" % (options.width, options.width), "--samples", "1", "--fit", "box", "--quiet",
                "--no-index"]
    isorender = os.path.join(options.bin, "isorender")

    def isorender_command(picture):
        return [isorender, volume, "-o", picture, *pictures]

    def isorender_rank(picture):
        return [*isorender_command(picture), "--threads", "1", "--chunk-size", "128"]

    programs = [Program("isorender", 1, isorender_command, {})]
    programs += [Program("mpirun isorender", n, isorender_rank, {}) for n in options.ranks]
    if options.paraview:
        root = os.path.abspath(options.paraview)
        script = os.path.join(os.path.dirname(volume), "frame.py")
        with open(script, "w", encoding="utf-8") as file:
            file.write(PVBATCH)

        def pvbatch(picture):
            return [os.path.join(root, "usr/bin/pvbatch"), script, volume, str(options.side), ISOVALUE, picture, str(options.width)]

        libraries = {"LD_LIBRARY_PATH": os.path.join(root, "usr/lib/x86_64-linux-gnu"),
                     "PYTHONPATH": os.path.join(root, "usr/lib/python3/dist-packages")}
        programs += [Program("mpirun pvbatch", n, pvbatch, libraries) for n in options.ranks]
    return programs


def main():
    if len(sys.argv) > 3 and sys.argv[1] == "--rank":
        sys.exit(as_rank(sys.argv[2], sys.argv[4:]))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", help="the folder of isorender")
    parser.add_argument("--paraview", help="the folder into which the packages paraview and python3-paraview were unpacked")
    parser.add_argument("--side", type=int, default=512, help="voxels along each axis")
    parser.add_argument("--width", type=int, default=1024, help="pixels")
    parser.add_argument("--ranks", type=lambda text: [int(n) for n in text.split(",")], default=[1, 2, 4])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--json")
    options = parser.parse_args()
    if not shutil.which("mpirun") or not glob.glob(os.path.join(options.bin, "../lib*/isopoint/libisopoint-mpi.so")):
        print("skipped: no mpirun, or built without MPI")
        sys.exit(77)
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    with tempfile.TemporaryDirectory() as folder:
        volume = os.path.join(folder, "waves_%dx%dx%d_uint8.raw" % ((options.side,) * 3))
        write_waves(volume, options.side)
        programs = list_programs(options, volume)
        for _ in range(options.runs):
            for program in programs:
                program.run(folder)
    print("%d^3 voxels of uint8, %d x %d pixels, median of %d" % (options.side, options.width, options.width, options.runs))
    print("%-18s %5s %9s %9s %11s %9s %6s" % ("", "ranks", "seconds", "processor", "peak MB", "differing", "failed"))
    rows, first = [], {}
    for program in programs:
        alone = first.setdefault(program.name.split()[-1], program)
        row = {"program": program.name, "ranks": program.ranks, "seconds": median(program.seconds),
               "processor_seconds": median(program.processor), "peak_bytes_of_a_rank": program.peak,
               "pixels_differing": differing(program.picture, alone.picture), "failed": program.failed}
        print("%-18s %5d %9.2f %9.2f %11.0f %9d %6d" % (row["program"], row["ranks"], row["seconds"], row["processor_seconds"],
                                                        row["peak_bytes_of_a_rank"] / 1e6, row["pixels_differing"], row["failed"]))
        rows.append(row)
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(rows, file, indent=1)


main()
