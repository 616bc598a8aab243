"""Aguirre, Gutierrez and Perrin 2010, Rendering Large Point Datasets with GPU Shaders: figures 4, 5 and 9."""
import array
import random
import sys

from measure import Vtk, points_for_vtk
from tables import Table, rate

COUNTS = (100, 1000, 10_000, 100_000, 1_000_000, 10_000_000)
MOST_POLYGONS = {"spheres": 100_000, "cones": 1_000_000}  # more do not fit into memory, or take minutes a frame
SIDE = 800


def scatter(machine, count, cones):
    """Random points in a cube of side 1: a .ply for isorender and a file for vtk_frame. Radii, or lengths of cones,
    are a third of the mean distance of neighbours."""
    numbers, size = random.Random(2010), 0.33 / count ** (1 / 3)
    positions = array.array("f", (numbers.random() for _ in range(3 * count)))
    directions = array.array("f")
    for _ in range(count if cones else 0):
        vector = [numbers.gauss(0, 1) for _ in range(3)]
        scale = 3 * size / sum(x * x for x in vector) ** 0.5
        directions.extend(x * scale for x in vector)
    name = "%s-%d" % ("cones" if cones else "spheres", count)
    columns = "xyz" + ("" if cones else "r")
    names = {"x": "x", "y": "y", "z": "z", "r": "radius"}
    with open(machine.path(name + ".ply"), "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % count)
        properties = [names[c] for c in columns] + (["nx", "ny", "nz"] if cones else [])
        file.write(b"".join(b"property float %s\n" % p.encode() for p in properties) + b"end_header\n")
        rows = array.array("f", bytes(4 * len(properties) * count))
        for i in range(3):
            rows[i::len(properties)] = positions[i::3]
        for i in range(3, len(properties)):
            rows[i::len(properties)] = directions[i - 3::3] if cones else array.array("f", [size]) * count
        if sys.byteorder == "big":
            rows.byteswap()
        rows.tofile(file)
    values = directions if cones else array.array("f", [size]) * count
    points_for_vtk(machine.path(name + ".vtk"), positions, values)
    if not cones and count <= MOST_POLYGONS["spheres"]:  # glyphs of polygons are scaled by a vector's length
        directions = array.array("f", bytes(12 * count))
        directions[0::3] = values
        points_for_vtk(machine.path("balls-%d.vtk" % count), positions, directions)
    return name


def vtk_rate(machine, kind, name):
    vtk = Vtk(machine, kind, machine.path(name + ".vtk"))
    vtk.look(SIDE, (0.5, -2.85, 0.5), (0.5, 0.5, 0.5))
    seconds = vtk.seconds_a_frame(3)
    vtk.close()
    return rate(seconds)


def our_rate(machine, name, *more):
    return rate(machine.seconds_a_frame(10, "--glyphs", name + ".ply", "--resolution", "%dx%d" % (SIDE, SIDE), *more))


def figures_4_and_5(machine, table):
    lead = []
    for count in COUNTS:
        name = scatter(machine, count, False)
        exact = our_rate(machine, name)
        polygons = vtk_rate(machine, "balls", "balls-%d" % count) if count <= MOST_POLYGONS["spheres"] else None
        sprites = vtk_rate(machine, "spheres", name)
        table.row("{:,} spheres, frames/s".format(count), exact, our_rate(machine, name, "--glyph-projection", "billboard"),
                  our_rate(machine, name, "--glyph-projection", "billboard", "--backend", machine.gl_backend()[0])
                  if count <= 100_000 else None, sprites, polygons)
        if polygons:
            lead.append((count, sprites.value / polygons.value, exact.value / sprites.value))
    _, command = machine.render("spheres.png", "--glyphs", "spheres-100000.ply", "--resolution", "512x512")
    table.picture("spheres.png", "100,000 spheres, exact", command)
    table.remark = ("On a processor projecting a box and solving a quadratic costs less than a rasterizer's set-up: ours are %.0f times as fast "
                    "as VTK's impostors." % lead[-1][2])
    million = next(cells[1].value for what, cells in table.rows if what.startswith("1,000,000 "))
    table.claim("With 100,000 spheres impostors are faster than polygons (VTK's, of 16 × 16 sides)", lead[-1][1] > 1, "%.2g times" % lead[-1][1])
    table.claim("A million billboards are drawn at 20 frames/s or more (the paper's GPU, our processor)", million >= 20,
                "%.3g frames/s" % million)


def figure_9(machine, table):
    lead = []
    for count in COUNTS:
        name = scatter(machine, count, True)
        glyph = ("--glyph", "cone")
        exact = our_rate(machine, name, *glyph)
        polygons = vtk_rate(machine, "cones", name) if count <= MOST_POLYGONS["cones"] else None
        table.row("{:,} cones, frames/s".format(count), exact,
                  our_rate(machine, name, *glyph, "--glyph-projection", "billboard"),
                  our_rate(machine, name, *glyph, "--glyph-projection", "billboard", "--backend", machine.gl_backend()[0])
                  if count <= 100_000 else None, polygons)
        if polygons:
            lead.append(exact.value / polygons.value)
    for projection in ("exact", "billboard"):
        _, command = machine.render("cones-%s.png" % projection, "--glyphs", "cones-1000.ply", "--glyph", "cone",
                                    "--glyph-projection", projection, "--resolution", "512x512")
        table.picture("cones-%s.png" % projection, "1,000 cones, %s" % projection, command)
    table.remark = "The paper says that polygons break down above 25,000 cones."
    table.claim("Cones solved in each pixel are faster than polygons of 16 sides (VTK's), the more so the more there are",
                lead[-1] > lead[0] > 1, "%.2g times with 100 cones, %.0f with a million" % (lead[0], lead[-1]))


def tables(machine):
    yield (Table("2010-figures-4-and-5", 2010, "Figures 4 and 5: spheres",
                 ["exact", "billboards", "billboards, gl engine", "VTK impostors", "VTK polygons"],
                 "Random spheres in a cube, %d × %d pixels. The paper's diagrams show about 20 frames/s with a million "
                 "shaded sprites, and polygons that fail above 10,000." % (SIDE, SIDE)),
           lambda table: figures_4_and_5(machine, table))
    yield (Table("2010-figure-9", 2010, "Figure 9: cones", ["exact", "billboards", "billboards, gl engine", "VTK polygons"],
                 "Random cones in a cube, %d × %d pixels." % (SIDE, SIDE)), lambda table: figure_9(machine, table))
