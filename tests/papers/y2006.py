"""Zhang and Pajarola 2006, Single-Pass Point Rendering and Transparent Shading: tables 1 and 2, section 6.2, figures 8
to 14."""
import array
import os

from measure import Number, read_ply_header
from tables import HARDLY_VISIBLE, Table, rate
from y2003 import Volumes, VOLUMES, vtk_rate

OVERLAPS = (1.0, 0.8, 0.6, 0.4)
# points in thousands, then groups and mean degree at each overlap
MODELS = (("David head", 2000, (18, 14, 11, 7), (17.2, 11.6, 9.4, 3.9)), ("Dragon", 1100, (14, 12, 8, 5), (8.8, 6.3, 3.0, 0.8)),
          ("Female", 303, (19, 15, 10, 8), (18.9, 13.2, 6.9, 2.3)), ("Balljoint", 137, (17, 12, 9, 5), (18.6, 13.6, 7.1, 2.3)))
LEVELS = {"generic": "without vectors", "": "with the processor's vectors"}  # ISO_CPU
FRAMES = (("David head", (0.96, 1.2, 1.4)), ("Dragon", (15.04, 19.70, 22.62)), ("Female", (32.65, 32.11, 37.76)),
          ("Balljoint", (65.68, 52.96, 70.37)))  # 2+1 passes, c = .8, c = .4
PICTURE = ("--resolution", "512x512", "--azimuth", "30", "--elevation", "10")


class Clouds:
    """Points in files: of the sculpted bear and head, and a scan where the reference data are there."""

    def __init__(self, machine, volumes):
        self.machine, self.volumes = machine, volumes

    def files(self):
        yield "bear", self.extracted(VOLUMES[0])
        yield "head", self.extracted(VOLUMES[1])
        scan = os.path.join(self.machine.source, "../shared/points/scans/igea.ply")
        if os.path.exists(scan):
            yield "igea (a scan)", scan

    def extracted(self, volume):
        path, options = self.volumes.input(volume)
        name = volume[0] + "-points.ply"
        if not os.path.exists(self.machine.path(name)):
            self.machine.run("isorender", path, *options, "--no-image", "--points", name, "--quiet")
        return name


def groups_of_paper(degree):
    """Number of groups of the paper's model and overlap whose mean degree is nearest."""
    pairs = [pair for _, _, groups, degrees in MODELS for pair in zip(degrees, groups)]
    return min(pairs, key=lambda pair: abs(pair[0] - degree))[1]


def table_1(machine, clouds, table):
    for model, thousands, groups, degrees in MODELS:
        table.row("the paper: %s, %d thousand points: groups (mean degree)" % (model, thousands),
                  *(pair for both in zip(groups, degrees) for pair in both))
    more = []
    for name, path in clouds.files():
        cells = []
        for overlap in OVERLAPS:
            report, command = machine.render("groups.png", path, "--method", "splats", "--groups", 64,
                                             "--group-overlap", overlap, "--resolution", "64x64")
            groups, points = report["groups"][0], report["primitives"]["points"]
            degree = 2 * groups["overlaps"] / points
            more.append(groups["count"] - groups_of_paper(degree))
            cells += [Number(groups["count"], command), Number(degree, command)]
        table.row("ours: %s, %d thousand points" % (name, round(points / 1000)), *cells)
    table.remark = ("Ours are coloured greedily in the order of the points, the paper's points of most neighbours first: that order needs 21, 15, 9 and 6 "
                    "groups of the bear, and 22, 14, 10 and 6 of the scan.")
    table.claim("No more than two groups more than the paper's model of the nearest mean degree", max(more) <= 2,
                "%d to %d more" % (min(more), max(more)))


def table_2(machine, clouds, table):
    for model, paper in FRAMES:
        table.row("the paper: %s, frames/s" % model, *paper)
    gains = {level: [] for level in (*LEVELS, "gl")}
    for name, path in clouds.files():
        how = (path, "--method", "splats", "--resolution", "1024x1024", "--backend", "cpu", "--threads", 1)
        for level, title in LEVELS.items():
            two = rate(machine.seconds_a_frame(5, *how, "--selection", "all", level=level))
            one = [rate(machine.seconds_a_frame(5, *how, "--groups", 64, "--group-overlap", overlap, level=level))
                   for overlap in (0.8, 0.4)]
            table.row("ours: %s, %s, frames/s" % (name, title), two, *one)
            gains[level].append([number.value / two.value for number in one])
        how = (path, "--method", "splats", "--resolution", "1024x1024")
        two, *one = (rate(machine.gl_seconds_a_frame(3, *how, *more)) for more in (
            ("--selection", "all"), ("--groups", 64, "--group-overlap", .8), ("--groups", 64, "--group-overlap", .4)))
        table.row("ours: %s, gl engine, frames/s" % name, two, *one)
        gains["gl"].append([number.value / two.value for number in one])
    table.remark = ("Groups are scalar code; two passes have vectors for AVX2 and AVX-512, which a GPU's pipeline has for both: on the cpu "
                    "the claims are held against scalar code of both. The gl engine draws by %s, with all threads." % machine.gl_backend()[1])
    for level, engine in (("generic", "both without vectors"), ("gl", "gl engine")):
        for at, overlap, least, paper in ((0, .8, .8, ".81 to 1.3"), (1, .4, 1.07, "1.07 to 1.5")):
            found = [both[at] for both in gains[level]]
            table.claim("One pass at c = %g is at least %g times as fast as two (the paper: %s), %s" % (overlap, least, paper, engine),
                        min(found) >= least, "%.3g to %.3g times" % (min(found), max(found)))


# Standard blending: EWA splatting in two passes, which widens discs smaller than a pixel, as groups do.
STANDARD = ("--method", "splats", "--reconstruction", "ewa")


def figure_8(machine, clouds, table):
    """The whole bear, whose discs are about a pixel wide, and a part of it where they are several pixels wide."""
    path = clouds.extracted(VOLUMES[0])
    apart, relaxed = [], []
    for zoom, shown in ((1, "whole"), (3, "magnified 3 times")):
        how = (path, *PICTURE, "--zoom", zoom)
        names = {overlap: "groups-%g-%d.png" % (overlap, zoom) for overlap in OVERLAPS}
        _, command = machine.render("standard-%d.png" % zoom, *how, *STANDARD)
        table.picture("standard-%d.png" % zoom, "%s: standard blending" % shown, command)
        for overlap, name in names.items():
            _, command = machine.render(name, *how, "--method", "splats", "--groups", 64, "--group-overlap", overlap)
            table.row("%s, c = %g" % (shown, overlap), machine.compare(names[1.0], name)("psnr_in"),
                      machine.compare("standard-%d.png" % zoom, name)("psnr_in"))
            if overlap in (1.0, 0.4):
                table.picture(name, "%s: groups, c = %g" % (shown, overlap), command)
        worst = table.rows[-1][1]
        relaxed.append(worst[0].value)
        apart.append(worst[1].value)
    table.remark = "Standard blending is EWA here. Where discs are about a pixel wide, pictures differ at outlines."
    table.claim("At c = .4, where discs of a group overlap, the picture hardly differs from that without any overlap (30 dB)",
                min(relaxed) >= HARDLY_VISIBLE, "%.1f and %.1f dB" % tuple(relaxed))
    for found, shown in zip(apart, ("of the whole bear", "where discs are several pixels wide")):
        table.claim("At c = .4 the picture %s hardly differs from standard blending (30 dB)" % shown, found >= HARDLY_VISIBLE,
                    "%.1f dB" % found)


def figure_9(machine, clouds, table):
    """With bins so thin that depth alone decides, the nearer disc of a group overrides the other: figure 9 a and b."""
    path = clouds.extracted(VOLUMES[0])
    how = ("--method", "splats", "--groups", 64, "--zoom", 6, *PICTURE)
    machine.render("voronoi-truth.png", path, *how)
    ways = (("by depth alone", ("--group-bins", 2 ** 20)), ("as a Voronoi diagram, eq. 6 and 10", ("--group-bins", 256)),
            ("as a Voronoi diagram, ours", ()))
    for i, (title, more) in enumerate(ways):
        name = "voronoi-%d.png" % i
        _, command = machine.render(name, path, *how, "--group-overlap", 0.4, *more)
        table.row("overlaps within a group decided %s" % title, machine.compare("voronoi-truth.png", name)("psnr_in"))
        table.picture(name, "overlaps decided %s" % title, command)
    depth, paper, ours = (cells[0].value for _, cells in table.rows)
    table.claim("The Voronoi diagram of eq. 10 is nearer to groups without overlaps than depth alone, by 1 dB or more",
                paper >= depth + 1, "%.1f and %.1f dB" % (paper, depth))
    table.claim("So is our way, which needs no bins", ours >= depth + 1, "%.1f dB" % ours)


def figure_10(machine, clouds, table):
    for name, path in clouds.files():
        pictures = ["models-%s-%s.png" % (name.split()[0], what) for what in ("standard", "groups")]
        how = (path, *PICTURE, *(("--up", "+y") if name.startswith("igea") else ()))
        machine.render(pictures[0], *how, *STANDARD)
        _, command = machine.render(pictures[1], *how, "--method", "splats", "--groups", 64, "--group-overlap", 0.4)
        table.row(name, machine.compare(*pictures)("psnr_in"))
        table.picture(pictures[1], "%s, one pass, c = .4" % name, command)
    found = [cells[0].value for _, cells in table.rows]
    table.remark = "Standard blending is EWA here, as in figure 8. Outlines differ most."
    table.claim("Pictures in one pass with c = .4 hardly differ from standard blending (30 dB)", min(found) >= HARDLY_VISIBLE,
                "%.1f to %.1f dB" % (min(found), max(found)))


def figure_11(machine, clouds, table):
    path = clouds.extracted(VOLUMES[0])
    how = (path, "--method", "splats", "--opacity", 0.5, "--opacity-mode", "constant", *PICTURE)
    machine.render("grouping-sorted.png", *how)
    for count in (4, 8):
        name = "grouping-%d.png" % count
        _, command = machine.render(name, *how, "--transparency", "groups", "--groups", count)
        table.row("algorithm 2, %d groups" % count, machine.compare("grouping-sorted.png", name)("psnr_in"))
        table.picture(name, "algorithm 2, %d groups" % count, command)
    for count in (4, 8):
        name = "copies-%d.png" % count
        _, command = machine.render(name, *how, "--transparency", "groups", "--groups", count, "--group-radii", "copies")
        table.row("algorithm 2, %d groups with copies of discs" % count,
                  machine.compare("grouping-sorted.png", name)("psnr_in"))
        table.picture(name, "algorithm 2, %d groups with copies of discs" % count, command)
    four, eight, copies, _ = (cells[0].value for _, cells in table.rows)
    table.claim("4 groups are nearer to sorted layers than 8", four > eight, "%.1f and %.1f dB" % (four, eight))
    table.claim("With 4 groups copies of discs, the paper's choice, are nearer than enlarged discs", copies > four,
                "%.1f and %.1f dB" % (copies, four))


def ply_bounds(path):
    with open(path, "rb") as file:
        (_, count, properties), = read_ply_header(file)
        floats = array.array("f", file.read())
    width = len(floats) // count
    assert len(properties) == width and all("float" in line for line in properties), path
    return [(min(floats[axis::width]), max(floats[axis::width])) for axis in range(3)]


def figure_13(machine, clouds, table):
    """Opaque spheres inside the translucent bear, behind it and before it."""
    path = clouds.extracted(VOLUMES[0])
    bounds = ply_bounds(machine.path(path))
    middle, size = [(lo + hi) / 2 for lo, hi in bounds], max(hi - lo for lo, hi in bounds)
    with open(machine.path("opaque.csv"), "w", encoding="utf-8") as file:
        file.write("x,y,z,radius,red,green,blue\n")
        for place, radius, color in (((0, 0, -.1), .09, (180, 40, 40)), ((.25, .6, .1), .12, (40, 90, 170)),
                                     ((-.25, .55, .25), .12, (50, 130, 60)), ((.1, -.45, .2), .06, (200, 160, 40))):
            file.write(",".join("%g" % n for n in (*(m + size * p for m, p in zip(middle, place)), size * radius, *color)) + "\n")
    how = (path, "--method", "splats", "--opacity", 0.5, "--opacity-mode", "constant", "--glyphs", "opaque.csv", *PICTURE)
    for kind, title in (("sorted", "sorted splat layers"), ("groups", "algorithm 2"), ("nearest", "algorithm 3")):
        name = "opaque-%s.png" % kind
        _, command = machine.render(name, *how, "--transparency", kind)
        table.picture(name, title, command)
        if kind != "sorted":
            table.row(title, machine.compare("opaque-sorted.png", name)("psnr_in"))
    two, three = (cells[0].value for _, cells in table.rows)
    for number, found in ((2, two), (3, three)):
        table.claim("With opaque objects inside, behind and before, algorithm %d hardly differs from sorted layers (30 dB)" % number,
                    found >= HARDLY_VISIBLE, "%.1f dB" % found)


def transparency(machine, clouds, table):
    path = clouds.extracted(VOLUMES[0])
    vdb, options = clouds.volumes.input(VOLUMES[0])
    paper = {"groups": 9, "nearest": 5, "sorted": None}
    names = {"groups": "algorithm 2 (groups)", "nearest": "algorithm 3 (nearest layer first)", "sorted": "sorted splat layers"}
    for opacity in (0.3, 0.5, 0.7):
        truth = "sorted-%g.png" % opacity
        machine.render(truth, path, "--method", "splats", "--opacity", opacity, "--opacity-mode", "constant", *PICTURE)
        for kind in ("groups", "nearest"):
            name = "%s-%g.png" % (kind, opacity)
            _, command = machine.render(name, path, "--method", "splats", "--opacity", opacity, "--opacity-mode", "constant",
                                        "--transparency", kind, *PICTURE)
            table.row("%s, opacity %g" % (names[kind], opacity), None, None, None, machine.compare(truth, name)("psnr_in"))
            if opacity == 0.5:
                table.picture(name, names[kind], command)
    for kind, rate_2006 in paper.items():
        seconds = machine.seconds_a_frame(3, path, "--method", "splats", "--opacity", 0.5, "--opacity-mode", "constant",
                                          "--transparency", kind, "--resolution", "512x512")
        gl = machine.gl_seconds_a_frame(3, path, "--method", "splats", "--opacity", 0.5, "--opacity-mode", "constant",
                                        "--transparency", kind, "--resolution", "512x512")
        table.row("%s, frames/s" % names[kind], rate_2006, rate(seconds), rate(gl), None)
    exact = machine.seconds_a_frame(5, vdb, *options, "--opacity", 0.5, "--opacity-mode", "constant", "--resolution", "512x512")
    table.row("exact, every layer of the field, frames/s", None, rate(exact), None, None)
    opaque = [seconds(3, path, "--method", "splats", "--selection", "all", "--resolution", "512x512")
              for seconds in (machine.seconds_a_frame, machine.gl_seconds_a_frame)]
    table.row("opaque splats in two passes, frames/s", 14, *(rate(seconds) for seconds in opaque), None)
    table.row("VTK: depth peeling of the mesh (the paper: 8 layers at most), frames/s", 2,
              vtk_rate(machine, "bear-peeled", vdb, options, opacity=0.5, peels=100, side=512), None, None)
    _, command = machine.render("sorted-picture.png", path, "--method", "splats", "--opacity", 0.5, "--opacity-mode", "constant",
                                *PICTURE)
    table.picture("sorted-picture.png", "sorted splat layers", command)
    rates = {what: cells[1].value for what, cells in table.rows if cells[1]}
    dB = {what: cells[3].value for what, cells in table.rows if cells[3]}
    three, two, best = (rates["%s, frames/s" % names[kind]] for kind in ("nearest", "groups", "sorted"))
    peeling = rates["VTK: depth peeling of the mesh (the paper: 8 layers at most), frames/s"]
    table.remark = ("Sorting every layer draws %.3g frames/s here. Against rays through the field instead of sorted layers the order is the other "
                    "way round (./run bench quality)." % best)
    for number, kind in ((2, "groups"), (3, "nearest")):
        found = min(dB["%s, opacity %g" % (names[kind], opacity)] for opacity in (.3, .5, .7))
        table.claim("Algorithm %d hardly differs from sorted layers (30 dB)" % number, found >= HARDLY_VISIBLE, "%.1f dB at least" % found)
    table.claim("Algorithm 2 is at least 4.5 times as fast as depth peeling (VTK's, of the mesh, here)", two >= 4.5 * peeling,
                "%.3g times" % (two / peeling))
    table.claim("Algorithm 3 is at least 2.5 times as fast", three >= 2.5 * peeling, "%.3g times" % (three / peeling))


def figure_14(machine, clouds, table):
    """Single and multiple layers of the bear's points, and what rays traced through its field show."""
    path = clouds.extracted(VOLUMES[0])
    vdb, options = clouds.volumes.input(VOLUMES[0])
    look = ("--ior", 1.5, "--samples", 4, *PICTURE)
    absorbs, tint = ("--opacity", 0.15), ("--attenuation-color", "8FD3C0", "--attenuation-distance", 30)
    for name, title, how in (("single", "single layer", ("--refraction", "single", "--transparency", "nearest", *absorbs)),
                             ("layers", "several layers, by accumulated opacity", ("--transparency", "nearest", *absorbs)),
                             ("dispersed", "the same with dispersion", ("--transparency", "nearest", *absorbs, "--dispersion", 20)),
                             ("sorted", "several layers, sorted", ("--refraction", "layers", *absorbs)),
                             ("two-sided", "two-sided", tint)):
        picture = "glass-%s.png" % name
        _, command = machine.render(picture, path, *look, *how)
        table.picture(picture, "points, " + title, command)
    fields = (("field-single", ("--refraction", "single", *absorbs)), ("field-layers", ("--refraction", "layers", *absorbs)),
              ("field-two-sided", ("--refraction", "two-sided", *tint)), ("field-traced", tint))
    for name, how in fields:
        _, command = machine.render("glass-%s.png" % name, vdb, *options, *look, *how)
    table.picture("glass-field-traced.png", "the field, traced", command)
    for title, truth, name in (("single layer (nearest), to the field's", "single", "single"),
                               ("several layers (accumulated opacity), to the field's", "layers", "layers"),
                               ("several layers (sorted), to the field's", "layers", "sorted"),
                               ("single layer, to several layers", "layers", "single"),
                               ("two-sided, to rays traced through the field", "traced", "two-sided")):
        table.row(title, machine.compare("glass-field-%s.png" % truth, "glass-%s.png" % name)("psnr_in"))
    table.row("two sides of the field itself, to rays traced through it",
              machine.compare("glass-field-traced.png", "glass-field-two-sided.png")("psnr_in"))
    single, several, _, apart, traced, _ = (cells[0].value for _, cells in table.rows)
    table.remark = "Neither is how light goes: for that rays are bent where they enter and leave the points' solid."
    table.claim("Layers of points refract and absorb as those of the field do (30 dB), single and several",
                min(single, several) >= HARDLY_VISIBLE, "%.1f and %.1f dB" % (single, several))
    table.claim("One layer differs visibly from several (less than 30 dB)", apart < HARDLY_VISIBLE, "%.1f dB" % apart)
    table.claim("Rays bent at both sides of the points' solid are 20 dB from traced ones", traced >= 20, "%.1f dB" % traced)


def tables(machine):
    clouds = Clouds(machine, Volumes(machine))
    yield (Table("2006-table-1", 2006, "Table 1: groups of splats",
                 [text for c in OVERLAPS for text in ("groups, c = %g" % c, "mean degree")],
                 "The paper's models are not free to use: ours are points of sculptures and a scan."),
           lambda table: table_1(machine, clouds, table))
    yield (Table("2006-table-2", 2006, "Table 2: one pass against two",
                 ["two passes", "one pass, c = .8", "one pass, c = .4"],
                 "1024 × 1024 pixels, one thread. Two passes: a depth pass over all discs, then one that adds them up (--selection all)."),
           lambda table: table_2(machine, clouds, table))
    yield (Table("2006-figure-8", 2006, "Figure 8: relaxed overlaps",
                 ["PSNR inside to c = 1, dB", "to standard blending, dB"],
                 "The paper shows pictures only."), lambda table: figure_8(machine, clouds, table))
    pictures = ("The paper shows pictures only.", "PSNR inside to sorted layers, dB")
    yield (Table("2006-figure-9", 2006, "Figure 9: Voronoi rasterization", ["PSNR inside to groups without overlaps, dB"],
                 "c = .4, magnified. " + pictures[0]), lambda table: figure_9(machine, clouds, table))
    yield (Table("2006-figure-10", 2006, "Figure 10: models in one pass", ["PSNR inside to standard blending, dB"], pictures[0]),
           lambda table: figure_10(machine, clouds, table))
    yield (Table("2006-figure-11", 2006, "Figure 11: the number of groups", [pictures[1]],
                 "Opacity .5. " + pictures[0]), lambda table: figure_11(machine, clouds, table))
    yield (Table("2006-figure-13", 2006, "Figure 13: opaque and translucent objects", [pictures[1]], "Opacity .5. " + pictures[0]),
           lambda table: figure_13(machine, clouds, table))
    yield (Table("2006-figure-14", 2006, "Figure 14: reflection and refraction", ["PSNR inside, dB"],
                 "The paper shows pictures only. Each surface takes .15 of the light (two-sided: the solid is tinted)."),
           lambda table: figure_14(machine, clouds, table))
    yield (Table("2006-transparency", 2006, "Section 6.2 and figure 12: transparency",
                 ["the paper, frames/s", "ours, frames/s", "gl engine, frames/s", "PSNR inside to sorted layers, dB"],
                 "512 × 512 pixels, constant opacity; the paper does not say the size of its pictures."),
           lambda table: transparency(machine, clouds, table))
