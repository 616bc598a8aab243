"""Baerentzen and Christensen 2003, Hardware Accelerated Point Rendering of Isosurfaces: tables 2 to 4, figures 4 and 5."""
import json
import os

from measure import Number, Vtk, mesh_for_vtk
from tables import HARDLY_VISIBLE, Table, rate, ratio

SIDE = 800  # pixels, as in table 4

# name, title, how it is made, isorender's options, the paper's numbers: points, triangles, their generation in
# seconds, frames a second of points, triangles and strips, share of indices of strips
VOLUMES = (
    ("bear", "bear, level set 256³", ("volumes/bear.strokes", 0.5), (),
     (274896, 464940, 1.22, 20.22, 22.93, 22.94, 31.52, 52)),
    ("head", "head, level set 1024³", ("volumes/head.strokes", 0.125), (),
     (728970, 1242784, 5.95, 50.53, 7.38, 4.06, 4.09, 51)),
    ("ct", "skull, 256³ bytes (ours: the scene ct)", None, (),
     (762303, 1478130, 14.79, 125.81, 8.67, 1.51, 3.93, 52)),
    ("stent", "engine, 256³ bytes (ours: the stent, 128² × 256)", None, ("--isovalue", "600"),
     (300108, 599256, 6.45, 34.82, 21.25, 3.70, 16.33, 45)),
)
# bear and head: cells, cells with a surface, frames a second of triangles and points with dirty cells
DIRTY = {"bear": (9.89, 17.67), "head": (3.08, 6.49)}
VIEWPORTS = {100: (773, 161), 800: (76, 146)}  # points, triangles


class Volumes:
    """The four volumes, made when first asked for, with the report's measurements of each."""

    def __init__(self, machine):
        self.machine, self.costs = machine, {}

    def input(self, volume):
        name, _, strokes, options, _ = volume
        if name == "ct":
            return "scene:ct:256", options
        if name == "stent":
            return os.path.join(self.machine.source, "volumes/stent.nrrd"), options
        path = self.machine.path(name + ".vdb")
        if not os.path.exists(path):
            self.machine.run("isosculpt", "--replay", os.path.join(self.machine.source, strokes[0]), "--headless",
                             "--voxel-size", strokes[1], "--output", path, "--quiet")
        return name + ".vdb", options

    def cost(self, volume):
        if volume[0] not in self.costs:
            path, options = self.input(volume)
            self.costs[volume[0]] = self.machine.cost(volume[0] + "-report", path, *options)
        return self.costs[volume[0]]

    def method(self, volume, method):
        """A function that gives a Number of a method's row in the report."""
        cost, command = self.cost(volume)
        row = next(row for row in cost["rows"] if row["method"] == method)
        return lambda *keys: Number(row[keys[0]] if len(keys) == 1 else row[keys[0]][keys[1]], command)


def gl_rate(machine, path, options, *more):
    """Frames a second of the gl engine, see Machine.gl_backend."""
    return rate(machine.gl_seconds_a_frame(20, path, *options, "--resolution", "%dx%d" % (SIDE, SIDE), *more))


def vtk_rate(machine, name, path, options, opacity=1.0, peels=0, side=SIDE):
    """Frames a second of VTK, of the mesh of the volume's surface; peels: see Vtk.opacity."""
    mesh = machine.path(name + ".ply")
    machine.run("isorender", path, *options, "--no-image", "--mesh", mesh, "--quiet")
    _, centre, radius = mesh_for_vtk(mesh, mesh + ".vtk")
    vtk = Vtk(machine, "mesh", mesh + ".vtk")
    vtk.look(side, (centre[0], centre[1] - radius / 0.2588, centre[2]), centre)
    if opacity < 1:
        vtk.opacity(opacity, peels)
    seconds = vtk.seconds_a_frame()
    vtk.close()
    os.remove(mesh)
    os.remove(mesh + ".vtk")
    return rate(seconds)


def table_2(machine, volumes, table):
    table.text += " The gl engine: %s." % machine.gl_backend()[1]
    for volume in VOLUMES:
        name, title, _, options, paper = volume
        path, _ = volumes.input(volume)
        points, mesh, exact = (volumes.method(volume, method) for method in ("points", "mesh", "exact"))
        table.row("%s: points" % title, paper[0], points("primitives"), None, None, None)
        table.row("triangles", paper[1], mesh("primitives"), None, None, None)
        table.row("points, generation, s", paper[2], points("extraction_seconds"), None,
                  exact("extraction_seconds"), None)
        table.row("triangles, generation, s", paper[3], mesh("extraction_seconds"), None, None, None)
        table.row("points, frames/s", paper[4], rate(points("frame", "seconds")),
                  gl_rate(machine, path, options, "--method", "points", "--point-scaling", "attenuated"),
                  rate(exact("frame", "seconds")), None)
        table.row("triangles, frames/s", paper[5], rate(mesh("frame", "seconds")),
                  gl_rate(machine, path, options, "--method", "mesh"), None, vtk_rate(machine, name, path, options))
        cost, command = volumes.cost(volume)
        table.row("strips, frames/s", paper[6], None,
                  gl_rate(machine, path, options, "--method", "mesh", "--strips"), None, None)
        table.row("strips, % of the indices", paper[7], Number(100 * cost["strip_indices"], command), None, None, None)
    table.remark = ("Two thirds of the work of Marching Cubes is triangles, and our Marching Cubes is vectorised as well as our points "
                    "are; exact needs neither: it is drawn from the field. The paper's head is the row of its Athlon.")
    faster = [ratio(volumes.method(v, "mesh")("extraction_seconds"), volumes.method(v, "points")("extraction_seconds"))
              for v in VOLUMES]
    table.claim("Points are generated at least 5 times as fast as triangles (the paper: 5.4 to 17)", min(faster) >= 5,
                "%.1f to %.1f times" % (min(faster), max(faster)))
    for engine, at in (("cpu", 1), ("gl", 2)):
        rates = {what: [cells[at].value for title, cells in table.rows if title == what + ", frames/s"]
                 for what in ("points", "triangles")}
        drawn = [points / triangles for points, triangles in zip(rates["points"], rates["triangles"])]
        table.claim("Points are drawn at least as fast as triangles (the paper: 1.0 to 5.7), %s engine" % engine,
                    min(drawn) >= 1, "%.2g to %.2g times" % (min(drawn), max(drawn)))
    strips_claims(table)


def strips_claims(table):
    """What the paper says of strips; its head is the exception."""
    found = {what: [cells[at].value for title, cells in table.rows if title == what]
             for what, at in (("strips, frames/s", 2), ("triangles, frames/s", 2), ("strips, % of the indices", 1))}
    shares = found["strips, % of the indices"]
    gains = [strips / triangles for strips, triangles in zip(found["strips, frames/s"], found["triangles, frames/s"])]
    others = [gain for volume, gain in zip(VOLUMES, gains) if volume[0] != "head"]
    table.claim("Strips have at most 52 % of the indices (the paper: 45 to 52 %)", max(shares) <= 52,
                "%.3g to %.3g %%" % (min(shares), max(shares)))
    table.claim("They are drawn at least 1.3 times as fast as triangles, but for the head (the paper: 1.4 to 4.4), gl engine",
                min(others) >= 1.3, "%.2g to %.2g times" % (min(others), max(others)))


def table_3(machine, volumes, table):
    kept, gl_kept = {}, {}
    for volume in VOLUMES:
        name, title = volume[:2]
        if name not in DIRTY:
            continue
        triangles, points = DIRTY[name]
        gl = gl_dirty(machine, *volumes.input(volume))
        for method, paper in (("mesh", triangles), ("points", points), ("exact", None)):
            of = volumes.method(volume, method)
            still, edited = rate(of("frame", "seconds")), rate(of("edited_frame", "seconds"))
            drawn = [rate(seconds) for seconds in gl.get(method, ())] or [None, None]
            table.row("%s: %s, frames/s" % (title, method), paper, still, edited, *drawn)
            kept.setdefault(method, []).append(edited.value / still.value)
            if method in gl:
                gl_kept.setdefault(method, []).append(ratio(drawn[1], drawn[0]))
    for name in DIRTY:
        report, command = machine.report_of("%s-strokes-report" % name,
                                            os.path.join(machine.source, "volumes/%s.strokes" % name))
        strokes = report["strokes"]
        for row in strokes["rows"]:
            if row["method"] in ("mesh", "points", "exact"):
                seconds = row["frame_seconds"] + row["extraction_seconds"]
                table.row("%s, its %d strokes: %s, frames/s" % (name, strokes["strokes"], row["method"]), None,
                          Number(1 / row["frame_seconds"], command), Number(1 / seconds, command), None, None)
    table.remark = "A brick takes microseconds today, and the frame decides."
    for engine, found in (("cpu", kept), ("gl", gl_kept)):
        table.claim("Points keep at least 77 %% of their rate when dirty cells are generated again (the paper: 77 to 93), %s engine" % engine,
                    min(found["points"]) >= .77, "%.0f %%" % (100 * min(found["points"])))
        gap = [100 * (p - m) for p, m in zip(found["points"], found["mesh"])]
        table.claim("They keep at least 9 %% more than triangles do (the paper: 43 to 84 %% of their rate, 9 to 34 %% less), %s engine" % engine,
                    min(gap) >= 9, "%.0f to %.0f %% more" % (min(gap), max(gap)))


def gl_dirty(machine, path, options):
    """Seconds a frame without and with dirty cells by the gl engine, of mesh and points."""
    isovalue = options[options.index("--isovalue") + 1] if "--isovalue" in options else 0
    text, command = machine.run("gl_dirty", path, isovalue, 4, SIDE, 20)
    found = json.loads(text)
    return {method: [Number(found[name][key], command) for key in ("seconds", "seconds_edited")]
            for method, name in (("points", "points"), ("mesh", "triangles"))}


def table_4(machine, table):
    cost, command = machine.cost("cube-report", "scene:cube:32")
    methods = {row["method"]: row for row in cost["rows"]}
    rates, gl_rates = {}, {}
    for side in cost["viewports"]:
        at = cost["viewports"].index(side)
        for method, name in (("points", "points"), ("mesh", "triangles"), ("exact", "exact")):
            seconds = Number(methods[method]["viewports"][at]["seconds"], command)
            rates[method, side] = rate(seconds)
            paper = VIEWPORTS.get(side, (None, None, None))[("points", "mesh").index(method)] \
                if side in VIEWPORTS and method != "exact" else None
            drawn = None
            if method != "exact" and side in VIEWPORTS:
                how = ("--point-scaling", "attenuated") if method == "points" else ()
                drawn = gl_rates[method, side] = rate(machine.gl_seconds_a_frame(
                    20, "scene:cube:32", "--method", method, *how, "--resolution", "%dx%d" % (side, side)))
            table.row("%s, %d × %d, frames/s" % (name, side, side), paper, rates[method, side], drawn)
    table.remark = "On a processor both are bound by the pixels of so small an object, which a GPU fills for nothing."
    for engine, found in (("cpu", rates), ("gl", gl_rates)):
        loss = {method: found[method, 100].value / found[method, 800].value for method in ("points", "mesh")}
        table.claim("From 100² to 800² pixels points lose at least twice the factor that triangles lose (the paper: 10 and 1.1), "
                    "%s engine" % engine, loss["points"] >= 2 * loss["mesh"], "%.2g and %.2g" % (loss["points"], loss["mesh"]))


def figure_4(machine, table):
    size = ("--resolution", "512x512", "--orthographic", "--samples", "4")
    truth, _ = machine.render("cylinder-truth.png", "scene:cylinder:32", "--method", "raycast", *size)
    voxel = truth["volume"]["spacing"][0] / truth["camera"]["mm_per_pixel"]  # pixels
    for method, title, more in (("points", "points as discs (OpenGL's way)", ()),
                                ("splats", "points as ellipses (the software way)", ("--reconstruction", "onepass")),
                                ("discs", "points as curved discs", ()),
                                ("mesh", "Marching Cubes", ()), ("exact", "exact", ())):
        name = "cylinder-%s.png" % method
        _, command = machine.render(name, "scene:cylinder:32", "--method", method, *more, *size)
        metric = machine.compare("cylinder-truth.png", name, "--pixels-per-voxel", "%.6g" % voxel)
        table.row(title, metric("dilation_mean_voxel"), metric("psnr_in"))
        table.picture(name, title, command)
    dilation = {what: cells[0].value for what, cells in table.rows}
    discs, ellipses, curved = list(dilation.values())[:3]
    table.claim("Discs that face the eye widen the cylinder visibly, by half a voxel or more", discs >= .5, "%.2g voxels" % discs)
    table.claim("Ellipses cure most of it: they widen it by less than half as much", abs(ellipses) < discs / 2,
                "%.2g voxels; our curved discs %.2g" % (ellipses, curved))


def figure_5(machine, volumes, table):
    path, _ = volumes.input(VOLUMES[1])
    view = ("--azimuth", "30", "--elevation", "8", "--zoom", "3", "--resolution", "512x512")
    machine.render("head-truth.png", path, "--method", "raycast", *view)
    for method, title in (("points", "points"), ("mesh", "triangles"), ("exact", "exact")):
        name = "head-%s.png" % method
        _, command = machine.render(name, path, "--method", method, *view)
        table.row(title, machine.compare("head-truth.png", name)("psnr_in"))
        table.picture(name, "head, %s" % title, command)
    likeness = machine.compare("head-mesh.png", "head-points.png")("psnr_in").value
    table.remark = "They differ at outlines, and where the surface bends."
    table.claim("At 1024³ points hardly differ from triangles (30 dB)", likeness >= HARDLY_VISIBLE, "%.1f dB" % likeness)


def tables(machine):
    volumes = Volumes(machine)
    yield (Table("2003-table-2", 2003, "Table 2: primitives, their generation, and frames a second",
                 ["the paper", "its method, cpu engine", "its method, gl engine", "exact", "VTK"],
                 "Frames of %d × %d from random directions; medians. VTK draws with Mesa's software renderer." % (SIDE, SIDE)),
           lambda table: table_2(machine, volumes, table))
    yield (Table("2003-table-3", 2003, "Table 3: frames with dirty cells",
                 ["the paper, with dirty cells", "ours, without", "ours, with", "gl engine, without", "gl engine, with"],
                 "The paper marks 20 and 400 random cells before each frame, so that about four with a surface are "
                 "regenerated; ours are four bricks with a surface, and the strokes of the stroke files (at 256³)."),
           lambda table: table_3(machine, volumes, table))
    yield (Table("2003-table-4", 2003, "Table 4: fill-rate, a cube in 32³ voxels", ["the paper", "ours, cpu engine", "ours, gl engine"],
                 "Few, large primitives."), lambda table: table_4(machine, table))
    yield (Table("2003-figure-4", 2003, "Figure 4: dilation of a cylinder",
                 ["dilation, voxels", "PSNR inside, dB"],
                 "The paper shows pictures only. Dilation and PSNR are against rays through the field."),
           lambda table: figure_4(machine, table))
    yield (Table("2003-figure-5", 2003, "Figure 5: detail of the head", ["PSNR inside, dB"],
                 "The paper shows pictures only; PSNR is against rays through the field."),
           lambda table: figure_5(machine, volumes, table))
