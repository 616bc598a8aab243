"""Marroquim, Kraus and Cavalcanti 2008, section 3.4: figures 5 (light) and 6 (colours)."""
import math
import os
import re
import struct
import sys
import zlib

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))

from check import Png
from measure import Number, read_ply_header
from tables import HARDLY_VISIBLE

SIDE = 512
LIT = ("sphere:48", "sphere:24", "sphere:16", "torus:48", "torus:24", "torus:16")  # the same size in pixels
COLORED = ("sphere:48", "torus:48", "gyroid:48")
EYE = (.35, -.8, .5)  # the direction to it
MATERIAL = (229, 220, 200)  # isorender's colour
RISE = 16  # pixels over which the steepness of a highlight is measured
HIGHLIGHT = 4  # of 255: where the exact surface's specular term is as bright, at most 41
SAME = 8  # of 255: pictures of two surfaces agree
BRIGHT, DARK = 191, 1  # colours of 255: no sum of light is beyond white; colours that are all 0 would not be used


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def view_of(scene, zoom=1):
    """The options of one parallel view, for the scene's surface and for its points."""
    voxels = int(scene.split(":")[1])
    middle = (voxels - 1) / 2
    eye = [middle + 4 * voxels * x for x in unit(EYE)]
    return ("--orthographic", "--camera-position", ",".join("%.9g" % x for x in eye), "--camera-focal-point", "%g,%g,%g" % (3 * (middle,)),
            "--mm-per-pixel", 1.1 * voxels / SIDE / zoom, "--resolution", "%dx%d" % (SIDE, SIDE))


def points_of(machine, scene):
    """Writes the points of a scene; returns the file's name, its properties and one tuple of floats for each point."""
    name = scene.replace(":", "-") + ".ply"
    machine.run("isorender", "scene:" + scene, "--no-image", "--points", name, "--quiet")
    with open(machine.path(name), "rb") as file:
        (_, count, properties), = read_ply_header(file)
        points = list(struct.iter_unpack("<%df" % len(properties), file.read()))
    assert len(points) == count and [line.split()[1] for line in properties[:6]] == ["x", "y", "z", "nx", "ny", "nz"], properties
    return name, properties, points


def write_colored(machine, name, properties, points, colors):
    with open(machine.path(name), "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points))
        for line in properties + ["uchar red", "uchar green", "uchar blue"]:
            file.write(b"property %s\n" % line.encode())
        file.write(b"end_header\n")
        form = "<%df3B" % len(properties)
        for point, color in zip(points, colors):
            file.write(struct.pack(form, *point, *color))


def write_png(path, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def rows_of(machine, name):
    return [[pixel[:3] for pixel in row] for row in Png(machine.path(name)).rows]


# ---- figure 5

def phong(machine):
    """The shading of render/shading/phong_simd.h in a parallel view, of a normal in view space, y down; 0 to 1."""
    with open(os.path.join(machine.source, "src/render/shading/phong.h"), encoding="utf-8") as file:
        value = {name: float(number) for name, number in re.findall(r"#define ISO_PHONG_(\w+) (-?[\d.]+)f", file.read())}
    light, to_eye = (value["LIGHT_X"], value["LIGHT_Y"], value["LIGHT_Z"]), (0, 0, -1)

    def shade(normal):
        facing = dot(normal, to_eye)
        side = -1 if facing < 0 else 1
        key, fill = max(side * dot(normal, light), 0), max(-side * normal[2], 0)
        mirror = max(2 * key * abs(facing) - dot(light, to_eye), 0) if key > 0 else 0
        white = value["SPECULAR"] * (mirror * mirror) ** 16
        diffuse = value["AMBIENT"] + value["KEY"] * key + value["FILL"] * fill
        return [min(base / 255 * diffuse + white, 1) for base in MATERIAL]

    return shade


def shaded_points(machine, properties, points):
    """Writes the points with the colours that they have when each is shaded by itself, white being BRIGHT, and all BRIGHT and all
    DARK; returns the files' names."""
    forward = unit([-x for x in EYE])
    right = unit(cross(forward, (0, 0, 1)))
    axes, shade = (right, cross(forward, right), forward), phong(machine)
    colors = [[round(BRIGHT * value) for value in shade(unit([dot(axis, point[3:6]) for axis in axes]))] for point in points]
    files = {"light-shaded.ply": colors, "light-bright.ply": [3 * (BRIGHT,)] * len(points), "light-dark.ply": [3 * (DARK,)] * len(points)}
    for name, of in files.items():
        write_colored(machine, name, properties, points, of)
    return list(files)


def draw_shaded_points(machine, files, view, picture):
    """Draws colours without light: interpolated colours c are shaded as c d + s, so that pictures in which c is BRIGHT and DARK
    tell d and s in every pixel. Returns the rows and the command."""
    found, command = [], ""
    for name in files:
        _, command = machine.render("light.png", name, *view, "--method", "splats")
        found.append(rows_of(machine, "light.png"))
    rows = [[tuple(min(max(round(255 / BRIGHT * (DARK + (BRIGHT - DARK) * (c - dark) / (bright - dark))), 0), 255) if bright > dark else 255
                   for c, bright, dark in zip(*pixels)) for pixels in zip(*lines)] for lines in zip(*found)]
    write_png(machine.path(picture), rows)
    return rows, command.replace(files[-1], files[0])


def steepest(rows, mask):
    """The steepest rise of brightness over RISE pixels of a row, where all these are in the mask; its 99th percentile."""
    rises = sorted(abs(row[x + RISE][1] - row[x][1]) for row, shown in zip(rows, mask) for x in range(SIDE - RISE)
                   if all(shown[x:x + RISE + 1]))
    return rises[int(.99 * (len(rises) - 1))]


def psnr(one, other, mask):
    square = count = 0
    for row, line, shown in zip(one, other, mask):
        for a, b, there in zip(row, line, shown):
            if there:
                square += sum((x - y) ** 2 for x, y in zip(a, b))
                count += 3
    return 10 * math.log10(255 ** 2 * count / square) if square else math.inf


def figure_5(machine, table):
    """Points that are shaded one by one and splatted, and normals that are interpolated and then shaded."""
    gains, differences = {}, []
    for scene in LIT:
        view, short = view_of(scene), scene.replace(":", "-")
        name, properties, points = points_of(machine, scene)
        shaded, command = draw_shaded_points(machine, shaded_points(machine, properties, points), view, "light-a-%s.png" % short)
        table.picture("light-a-%s.png" % short, "%s: non-deferred, the colours of shaded points" % scene, command)
        _, deferred = machine.render("light-b-%s.png" % short, name, *view, "--method", "pullpush")
        table.picture("light-b-%s.png" % short, "%s: deferred, in the pyramid" % scene, deferred)
        pictures = [shaded, rows_of(machine, "light-b-%s.png" % short)]
        commands = [command, deferred]
        _, exact = machine.render("light.png", "scene:" + scene, *view, "--method", "exact")
        pictures.append(rows_of(machine, "light.png"))
        commands.append(exact)
        machine.render("light.png", "scene:" + scene, *view, "--method", "exact", "--color", "000000")
        mask = [[HIGHLIGHT <= pixel[0] < 255 for pixel in row] for row in rows_of(machine, "light.png")]
        rises = [steepest(rows, mask) for rows in pictures]
        difference = psnr(*pictures[:2], mask)
        table.row("%s, %.1f thousand points" % (scene, len(points) / 1000), *(Number(rise, command) for rise, command in zip(rises, commands)), Number(difference, deferred))
        gains[scene] = rises[1] / rises[0]
        differences.append(difference)
    table.remark = "The pyramid keeps the steepness of the exact surface; points that are shaded one by one lose it where a highlight is not " \
        "many points wide."
    for size, what in (":16", "fewest"), (":48", "most"):
        of = [gain for scene, gain in gains.items() if scene.endswith(size)]
        table.claim("Deferred shading has sharper highlights, of the scenes with the %s points: over %d pixels they rise at least 1.1 times "
                    "as steeply" % (what, RISE), min(of) >= 1.1, "%.2f and %.2f times" % (min(of), max(of)))
    table.claim("Both differ visibly where the highlights are (below 30 dB)", max(differences) < HARDLY_VISIBLE,
                "%.1f to %.1f dB" % (min(differences), max(differences)))


# ---- figure 6

STRIPES = ((40, 60, 170), (200, 200, 195), (200, 60, 40), (200, 150, 60), (30, 120, 70), (120, 60, 150), (200, 195, 100), (60, 150, 190))


def stripe(height):
    """The colour of a height, 0 to 1, between the rows of a colormap."""
    at = min(max(height, 0), 1) * (len(STRIPES) - 1)
    i = min(int(at), len(STRIPES) - 2)
    return [round(a + (at - i) * (b - a)) for a, b in zip(STRIPES[i], STRIPES[i + 1])]


def write_heights(machine, voxels):
    """A volume of 2³ voxels whose values are heights z around the scene, and a colormap of the stripes; returns the options that
    colour a surface by them."""
    lo, hi = -voxels, 2 * voxels
    with open(machine.path("heights.mha"), "wb") as file:
        file.write(("ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementSpacing = %d %d %d\nOffset = %d %d %d\nElementType = MET_FLOAT\n"
                    "ElementDataFile = LOCAL\n" % (3 * (hi - lo,) + 3 * (lo,))).encode())
        file.write(struct.pack("<8f", *[lo] * 4, *[hi] * 4))
    with open(machine.path("stripes.txt"), "w", encoding="utf-8") as file:
        file.writelines("%d %d %d\n" % color for color in STRIPES)
    return "--surface-color-by", "heights.mha", "--range", "0,%d" % voxels, "--colormap", "stripes.txt"


def figure_6(machine, table):
    """Points of one colour, and with a colour each; the exact surface coloured by the same heights is the truth."""
    overlaps, found, largest = [], [], 0
    for scene in COLORED:
        short, voxels = scene.split(":", maxsplit=1)[0], int(scene.split(":")[1])
        name, properties, points = points_of(machine, scene)
        write_colored(machine, "colors-b.ply", properties, points, [stripe(point[2] / voxels) for point in points])
        write_colored(machine, "colors-c.ply", properties, points, [MATERIAL] * len(points))
        by_height = write_heights(machine, voxels)
        for zoom in 1, 4:
            view, shown = view_of(scene, zoom), "%s%s" % (short, ", magnified %d times" % zoom if zoom > 1 else "")
            names = ["colors-%s-%s-%d.png" % (which, short, zoom) for which in "abc"]
            commands = [machine.render(picture, source, *view, "--method", "pullpush")[1]
                        for picture, source in zip(names, (name, "colors-b.ply", "colors-c.ply"))]
            if zoom == 1:
                table.picture(names[0], short + ": the material's colour", commands[0])
                table.picture(names[1], short + ": a colour of each point", commands[1])
            machine.render("colors-exact.png", "scene:" + scene, *view, "--method", "exact")
            machine.render("colors-exact-b.png", "scene:" + scene, *view, "--method", "exact", *by_height)
            plain, colored, same, exact, truth = (rows_of(machine, picture) for picture in (*names, "colors-exact.png", "colors-exact-b.png"))
            mask = [[max(abs(x - y) for x, y in zip(a, b)) <= SAME and a != (255, 255, 255) for a, b in zip(*lines)]
                    for lines in zip(plain, exact)]
            inside, agrees = machine.compare("colors-exact-b.png", names[1])("psnr_in"), psnr(truth, colored, mask)
            table.row(shown, Number(agrees, commands[1]), inside)
            overlaps.append(machine.compare(names[0], names[1])("iou").value)
            found.append(agrees)
            largest = max(largest, max(abs(x - y) for lines in zip(plain, same) for a, b in zip(*lines) for x, y in zip(a, b)))
    table.claim("Colours change no outline: the pictures share all of their area", min(overlaps) == 1, "%.4g" % min(overlaps))
    table.claim("Where both surfaces look the same in the material's colour (within %d of 255), interpolated colours hardly differ from exact "
                "ones (30 dB)" % SAME, min(found) >= HARDLY_VISIBLE, "%.1f to %.1f dB" % (min(found), max(found)))
    table.claim("Points that all have the material's colour look as it does: no pixel differs by more than 1 of 255", largest <= 1,
                "%d at most" % largest)
