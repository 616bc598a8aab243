"""Marroquim, Kraus and Cavalcanti 2008, Efficient Image Reconstruction for Point-Based and Line-Based Rendering: table 1,
section 6, figures 13 to 16 and 19."""
import math
import os

from measure import Number, read_ply_header
from tables import Table, rate

# model, thousand points; ms a frame (projecting, pyramid) without colours; with
MODELS = (("Armadillo", 173, (11, 1.2, 8.5), (22, 1.5, 18)), ("Dragon", 437, (13, 2.2, 8.9), (23, 2.9, 18)),
          ("Happy Buddha", 544, (13, 2.6, 8.8), (24, 3.4, 18)), ("Asian Dragon", 3610, (28, 18, 8.3), (45, 25, 17)),
          ("Thai Statue", 5000, (35, 25, 8.2), (55, 34, 18)))
SIDE = 1024
BASE = 128  # voxels a side of the gyroid whose points are counted first


def gyroid_points(machine, size):
    """Points of a gyroid of size^3 voxels, in a file; returns its name and their number."""
    name = "gyroid-%d.ply" % size
    report, _ = machine.report("isorender", "scene:gyroid:%d" % size, "--no-image", "--points", name)
    return name, report["primitives"]["points"]


def color_points(machine, name):
    """The same points with a colour each, by their normals."""
    colored = "colored-" + name
    with open(machine.path(name), "rb") as file:
        (_, count, properties), = read_ply_header(file)
        data = file.read()
    width = len(data) // count
    out = bytearray((width + 3) * count)
    for i in range(width):
        out[i::width + 3] = data[i::width]
    for channel in range(3):  # the sign and the exponent of a component of the normal: a few different colours
        out[width + channel::width + 3] = data[4 * (3 + channel) + 3::width]
    with open(machine.path(colored), "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % count)
        for line in properties + ["uchar red", "uchar green", "uchar blue"]:
            file.write(b"property %s\n" % line.encode())
        file.write(b"end_header\n" + out)
    return colored


def table_1(machine, table):
    _, base = gyroid_points(machine, BASE)
    plain = []
    for model, thousands, without, with_colors in MODELS:
        size = round(BASE * math.sqrt(1000 * thousands / base))
        name, count = gyroid_points(machine, size)
        how = ("--method", "pullpush", "--resolution", "%dx%d" % (SIDE, SIDE), "--backend", "cpu")
        seconds = machine.seconds_a_frame(10, name, *how)
        colored = color_points(machine, name)
        color = machine.seconds_a_frame(10, colored, *how)
        plain.append((count, seconds.value, color.value / seconds.value))
        table.row("%s, %d thousand points (ours: %d), ms" % (model, thousands, round(count / 1000)), without[0],
                  Number(1e3 * seconds.value, seconds.command), with_colors[0], Number(1e3 * color.value, color.command))
        os.remove(machine.path(name))
        os.remove(machine.path(colored))
    more = (plain[-1][0] - plain[0][0]) / (plain[-1][1] - plain[0][1])
    table.judge("yes" if plain[-1][1] < 29 * plain[0][1] / 2 else "partly",
                "29 times as many points take %.2g times as long (the paper: 3.2), since the pyramid costs the same for all; "
                "a further point costs 1/%.0f million of a second (the paper: 130 M splats a second, here on a processor). "
                "Colours cost a factor of %.2g (the paper: 1.6 to 2)."
                % (plain[-1][1] / plain[0][1], more / 1e6, sum(p[2] for p in plain) / len(plain)))


def figures_13_and_19(machine, table):
    """A tree as lines (tubes and ribbons) and as triangles; ten trees are ten times as many of each."""
    _, command = machine.run("write_tree", machine.folder)
    size = ("--resolution", "%dx%d" % (SIDE, SIDE), "--backend", "cpu")
    ways = {
        "lines in the pyramid": ("--lines", "wood.vtk", "--line-style", "tube", "--lines", "leaves.vtk", "--line-style", "ribbon",
                                 "--method", "pullpush"),
        "lines as exact solids": ("--lines", "wood.vtk", "--line-style", "tube", "--lines", "leaves.vtk", "--line-style",
                                  "ribbon"),
        "triangles": ("--surface", "wood.ply", "--surface", "leaves.ply"),
    }
    paper = {"lines in the pyramid": 31, "triangles": 28}
    rates = {}
    for name, how in ways.items():
        picture = "tree-%s.png" % name.split()[-1]
        _, drawn = machine.render(picture, *how, "--resolution", "512x512", "--elevation", 5)
        table.picture(picture, "a tree: %s" % name, "%s; %s" % (command, drawn))
        rates[name] = rate(machine.seconds_a_frame(3, *how, *size))
        table.row("%s, frames/s" % name, paper.get(name), rates[name])
    lead = {name: rates[name].value / rates["triangles"].value for name in rates}
    table.judge("yes" if lead["lines in the pyramid"] > 1 else "no",
                "A tree as lines in the pyramid is drawn %.2g times as fast as its triangles, as exact tubes and ribbons %.2g times "
                "(the paper: 1.1 for a tree and 1.7 for ten)." % (lead["lines in the pyramid"], lead["lines as exact solids"]))


def figure_14(machine, table):
    """Helices of one radius in pixels each: a picture of 512 pixels shows 20 mm."""
    with open(machine.path("helix.obj"), "w", encoding="utf-8") as file:
        for i in range(400):
            angle = i * math.pi / 50
            file.write("v %.6f %.6f %.6f\n" % (7 * math.cos(angle), 7 * math.sin(angle), i / 25 - 8))
        file.write("l " + " ".join(str(i + 1) for i in range(400)) + "\n")
    overlaps = []
    for radius in (0.5, 1, 2, 8, 20):
        view = ("--lines", "helix.obj", "--tube-radius", radius * 20 / 512, "--mm-per-pixel", 20 / 512, "--resolution", "512x512",
                "--azimuth", 20, "--elevation", 15)
        machine.render("tubes-exact.png", *view)
        name = "tubes-%g.png" % radius
        _, command = machine.render(name, *view, "--method", "pullpush")
        metric = machine.compare("tubes-exact.png", name, "--pixels-per-voxel", 1)
        table.row("radius of %g pixels" % radius, metric("iou"), metric("dilation_mean"), metric("psnr_in"))
        table.picture(name, "tubes of a radius of %g pixels, in the pyramid" % radius, command)
        overlaps.append(metric("iou").value)
    table.judge("yes" if overlaps[-1] < max(overlaps) else "partly",
                "Tubes in the pyramid share %.2g to %.2g of their outline with exact tubes; the largest ones are visibly flat, as "
                "the paper says of close views." % (min(overlaps), max(overlaps)))


def figure_15(machine, table):
    """A mesh through points."""
    machine.run("isorender", "scene:torus:96", "--no-image", "--mesh", "torus.stl", "--quiet")
    view = ("scene:gyroid:96", "--surface", "torus.stl", "--resolution", "512x512", "--azimuth", 30, "--elevation", 20)
    _, command = machine.render("mixed-exact.png", *view)
    table.picture("mixed-exact.png", "the exact surface with the triangles", command)
    _, command = machine.render("mixed-pyramid.png", *view, "--method", "pullpush", "--one-pyramid")
    metric = machine.compare("mixed-exact.png", "mixed-pyramid.png")
    table.row("points and triangles in one pyramid", metric("psnr_in"), metric("holes"))
    table.picture("mixed-pyramid.png", "points (gyroid) and triangles (torus)", command)
    table.judge("yes" if metric("holes").value < 0.001 else "partly",
                "A mesh and points meet in one picture, of which %.2g %% are holes, at outlines; it is %.0f dB from the exact "
                "surface with the same mesh." % (metric("holes").value, metric("psnr_in").value))


def figure_16(machine, table):
    view = ("scene:torus:48", "--resolution", "1024x1024", "--azimuth", 40, "--elevation", 25, "--zoom", 1.3)
    machine.render("hybrid-exact.png", *view)
    for method in ("hybrid", "pullpush", "mesh"):
        name = "hybrid-%s.png" % method
        _, command = machine.render(name, *view, "--method", method)
        metric = machine.compare("hybrid-exact.png", name)
        table.row({"pullpush": "points"}.get(method, method), metric("psnr_in"), metric("holes"))
        table.picture(name, {"pullpush": "points"}.get(method, method), command)
    hybrid, points = (cells[0].value for _, cells in table.rows[:2])
    table.judge("yes" if hybrid > points else "partly",
                "Where cells are larger than 3 pixels they are triangles, elsewhere points; both meet without gaps, as the "
                "paper shows: %.1f dB from the exact surface, points alone %.1f." % (hybrid, points))


def tables(machine):
    yield (Table("2008-table-1", 2008, "Table 1 and section 6: time a frame",
                 ["the paper", "ours", "the paper, with colours", "ours, with colours"],
                 "Gaussian weights, %d × %d pixels, ms; our points are those of gyroids with as many." % (SIDE, SIDE)),
           lambda table: table_1(machine, table))
    yield (Table("2008-figures-13-and-19", 2008, "Figures 13 and 19: a tree as lines and as triangles", ["the paper", "ours"],
                 "The paper's tree is a commercial model: ours grows by the rules of Weber and Penn."),
           lambda table: figures_13_and_19(machine, table))
    yield (Table("2008-figure-14", 2008, "Figure 14: thin lines", ["IoU with exact tubes", "dilation, pixels", "PSNR inside, dB"],
                 "The paper shows a picture only."), lambda table: figure_14(machine, table))
    yield (Table("2008-figure-15", 2008, "Figure 15: points and triangles together", ["PSNR inside to exact, dB", "holes, %"],
                 "The paper shows a picture only."), lambda table: figure_15(machine, table))
    yield (Table("2008-figure-16", 2008, "Figure 16: hybrid surfaces", ["PSNR inside to exact, dB", "holes, %"],
                 "The paper shows a picture only."), lambda table: figure_16(machine, table))
