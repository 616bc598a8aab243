"""Runs the programs, VTK's frames among them, and keeps the command beside each number.

A number is a Number: its value, and the command that measured it. Times are medians; a frame's time is that of
the drawing alone. Everything is written into one folder, in which all commands are run."""
import array
import json
import math
import os
import shlex
import statistics
import struct
import subprocess


class Number:
    """A value with the command that gave it; None stands for a number that could not be measured. A mean over pixels has
    their 99th percentile and their maximum, which it hides."""

    def __init__(self, value, command, extremes=None):
        self.value, self.command, self.extremes = value, command, extremes


EXTREMES = {"psnr_in": ("error_p99", "error_max"), "dilation_mean": ("dilation_p99", "dilation_max")}


class Failed(Exception):
    """A program ended with an error; its text is the program's line."""


def one_sample(words):
    """The options of a picture, with one sample a pixel and the frame of the box, unless `words` say more: the tables are
    measured so."""
    words = words if "--samples" in words else (*words, "--samples", 1)
    return words if "--fit" in words else (*words, "--fit", "box")


class Machine:
    """Where the programs are, and where files go."""

    def __init__(self, programs, source, folder):
        self.programs, self.source, self.folder = programs, source, folder
        self.display = self.gl = None
        os.makedirs(folder, exist_ok=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, *words, level=""):
        """Runs a program of ours; returns what it printed, and the command as a user would type it. level: of ISO_CPU, or
        "", the processor's own."""
        words = [str(word) for word in words]
        command = ("ISO_CPU=%s " % level if level else "") + shlex.join(words).replace(self.source + "/", "")
        done = subprocess.run([os.path.join(self.programs, words[0]), *words[1:]], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "ISO_CPU": level} if level else None, check=False)
        if done.returncode != 0:
            raise Failed((done.stderr.strip().splitlines() or ["%s ended with %d" % (words[0], done.returncode)])[-1])
        return done.stdout, command

    def report(self, *words, level=""):
        """The same for a program with --json; returns the object and the command."""
        text, command = self.run(*words, "--json", "--quiet", level=level)
        return json.loads(text), command

    def render(self, name, *words):
        """One picture of isorender, NAME, with one sample a pixel unless `words` say more; its report and the command."""
        return self.report("isorender", *one_sample(words), "--output", name)

    def seconds_a_frame(self, frames, *words, level=""):
        """Seconds that isorender takes to draw a frame of a turntable."""
        report, command = self.report("isorender", *one_sample(words), "--turntable", frames, "--output", "turn_{n:3}.png", level=level)
        for frame in report["frames"]:
            os.remove(self.path(frame["path"]))
        return Number(report["seconds"]["render"] / frames, command)

    def gl_seconds_a_frame(self, frames, *words):
        """The same by the gl engine."""
        return self.seconds_a_frame(frames, *words, "--backend", self.gl_backend()[0])

    def compare(self, truth, candidate, *words):
        """Metrics of two pictures in the folder; returns a function from the metric's name to a Number."""
        report, command = self.report("isocompare", "images", truth, candidate, *words)

        def metric(name):
            value, extremes = report["metrics"][name], [report["metrics"][more] for more in EXTREMES.get(name, ())]
            return Number(math.inf if value == "inf" else value, command, extremes or None)

        return metric

    def bench(self, what, rows):
        """Rows of ./run bench WHAT whose names contain `rows`: by name, Google Benchmark's objects; and the command."""
        out = self.path("bench.json")
        _, command = self.run("bench", what, "--filter", rows, "--json", out)
        with open(out, encoding="utf-8") as file:
            return {row["name"]: row for row in json.load(file)["benchmarks"] if "real_time" in row}, command

    def gl_backend(self):
        """isorender's --backend for the gl engine, and what draws there: a GPU if there is one, else Mesa's llvmpipe."""
        if self.gl is None:
            lines, _ = self.run("isorender", "--list-backends")
            found = [line.split(None, 1) for line in lines.splitlines() if line.startswith(("egl", "osmesa"))]
            gpus = [line for line in found if line[0] == "egl" and "llvmpipe" not in line[1] and "OpenGL" in line[1]]
            backend, renderer = (gpus or [line for line in found if line[0] == "osmesa"])[0]
            self.gl = backend, renderer.strip() + ("" if gpus else "; there is no GPU")
        return self.gl

    def report_of(self, name, *words):
        """isocompare report on a volume or a stroke file; returns its numbers and the command."""
        _, command = self.run("isocompare", "report", *words, "--output", name, "--side", 256, "--quiet")
        with open(self.path(name + "/report.json"), encoding="utf-8") as file:
            return json.load(file), command

    def cost(self, name, *words):
        """What extraction and frames of a volume cost."""
        report, command = self.report_of(name, *words)
        return report["cost"], command


# ---- VTK

class Vtk:
    """vtk_frame of the bench, which draws a file of one kind with VTK on an X display without a screen."""

    def __init__(self, machine, kind, path):
        self.command = "vtk_frame %s %s" % (kind, os.path.basename(path))
        if machine.display is None:
            machine.display = start_display()
        self.program = subprocess.Popen([os.path.join(machine.programs, "vtk_frame"), kind, path], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                        env=dict(os.environ, DISPLAY=machine.display[1]))
        ready = self.program.stdout.readline().split(None, 2)
        if len(ready) < 3 or ready[0] != "ready":
            raise Failed("VTK draws nothing here")
        self.renderer = ready[2].strip()

    def ask(self, line):
        self.program.stdin.write(line + "\n")
        self.program.stdin.flush()
        return self.program.stdout.readline().split()

    def look(self, side, eye, focus, angle=30, up=(0, 0, 1)):
        numbers = [side, side, *eye, *focus, *up, angle, 0, 0]
        if self.ask("view " + " ".join("%.17g" % n for n in numbers)) != ["shown"]:
            raise Failed("VTK does not take this view")

    def opacity(self, opacity, peels):
        """peels 0: VTK's default, which averages colours."""
        if self.ask("opacity %g %d" % (opacity, peels)) != ["shown"]:
            raise Failed("VTK does not take this opacity")

    def seconds_a_frame(self, frames=5):
        self.ask("frame")
        times = [float(self.ask("frame")[1]) / 1e3 for _ in range(frames)]
        return Number(statistics.median(times), self.command)

    def close(self):
        self.program.stdin.close()
        self.program.stdout.close()
        self.program.wait()


def start_display():
    """An X server without a screen; returns its process and its name. It ends with this program."""
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24"], pass_fds=[write],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as pipe:
        return server, ":" + pipe.readline().strip()


# ---- files

def read_ply_header(file):
    """Returns the elements of a binary little-endian .ply: names, counts and lists of property lines."""
    elements = []
    for line in iter(file.readline, b"end_header\n"):
        words = line.split()
        if words[0] == b"element":
            elements.append((words[1].decode(), int(words[2]), []))
        elif words[0] == b"property":
            elements[-1][2].append(b" ".join(words[1:]).decode())
    return elements


def mesh_for_vtk(ply, out):
    """Writes a mesh of isorender (a .ply: x y z nx ny nz, triangles) as vtk_frame reads it; returns the number of
    triangles and the box's centre and radius."""
    with open(ply, "rb") as file:
        vertices, faces = read_ply_header(file)
        floats = array.array("f", file.read(4 * 6 * vertices[1]))
        records = file.read(13 * faces[1])
    positions, normals, corners = array.array("f"), array.array("f"), array.array("q")
    for axis in range(3):
        positions.extend(floats[axis::6])
        normals.extend(floats[axis + 3::6])
    count = vertices[1]
    by_vertex = [array.array("f", bytes(12 * count)) for _ in range(2)]
    for axis in range(3):
        by_vertex[0][axis::3] = positions[axis * count:(axis + 1) * count]
        by_vertex[1][axis::3] = normals[axis * count:(axis + 1) * count]
    for face in struct.iter_unpack("<xiii", records):
        corners.extend(face)
    with open(out, "wb") as file:
        file.write(struct.pack("<2q", count, faces[1]))
        for data in (*by_vertex, corners):
            data.tofile(file)
    lo = [min(positions[a * count:(a + 1) * count]) for a in range(3)]
    hi = [max(positions[a * count:(a + 1) * count]) for a in range(3)]
    return faces[1], [(l + h) / 2 for l, h in zip(lo, hi)], math.dist(lo, hi) / 2


def points_for_vtk(out, positions, values):
    """Writes points as vtk_frame reads them: flat arrays of x y z, and of radii or directions."""
    with open(out, "wb") as file:
        file.write(struct.pack("<2q", len(positions) // 3, 0))
        positions.tofile(file)
        values.tofile(file)


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return names[0] if names else "unknown"
