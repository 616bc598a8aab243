"""Guennebaud, Barthe and Paulin 2004, Deferred Splatting: tables 1 and 2, figure 3."""

from measure import Number
from tables import Table, rate, ratio
from y2003 import Volumes
from y2006 import Clouds

# scene, frames/s without selection, points culled in %, frames/s with
SCENES = (("Head (285k points)", 34, 70, 39), ("Tree (750k points)", 8.6, 88, 32), ("200 moving objects", 11.5, 90, 33.5),
          ("Forest of 6,800 trees (the middle of what it says)", 1.2, 94, 13))
PASSES = (("visibility splatting", 12.5), ("points of one pixel with their numbers", 100), ("EWA splatting", 12))
SIDE = 512


def culled(report, command):
    """The share of points that are not drawn, in percent."""
    selection = report["image"]["selection"]
    return Number(100 * (1 - selection["drawn"] / selection["points"]), command)


def table_1(machine, clouds, table):
    size = ("--resolution", "%dx%d" % (SIDE, SIDE), "--backend", "cpu", "--method", "pullpush")
    for name, *numbers in SCENES:
        table.row("the paper: %s" % name, *numbers)
    for name, path in clouds.files():
        report, command = machine.render("selected.png", path, *size)
        table.row("ours: %s, %d thousand points" % (name, round(report["primitives"]["points"] / 1000)), None,
                  culled(report, command), rate(machine.seconds_a_frame(5, path, *size)))
    rows, command = machine.bench("render", "render/forest/")
    gains = {}
    for count in sorted({name.split("/")[2] for name in rows}, key=int):
        all_of, selected, detail = (rows["render/forest/%s/%s/threads:1" % (count, mode)] for mode in ("all", "selected", "detail"))
        table.row("ours: forest of %s trees (%d million points)" % (count, round(all_of["million_points"])),
                  Number(1e3 / all_of["real_time"], command),
                  Number(100 * selected["hidden"] / (selected["hidden"] + selected["drawn"]), command),
                  Number(1e3 / selected["real_time"], command))
        table.row("the same, with levels of detail", None, None, Number(1e3 / detail["real_time"], command))
        gains[count] = all_of["real_time"] / selected["real_time"]
    best = max(gains.values())
    table.judge("yes" if best > 4 else "partly",
                "Drawing front to back and leaving out what nearer points hide makes a forest %.2g times as fast (the paper: "
                "10), without a frame before; single objects gain little on a processor, where hidden points are skipped "
                "in blocks anyway." % best)


def table_2(machine, clouds, table):
    _, path = next(pair for pair in clouds.files() if pair[0] == "head")
    size = ("--resolution", "%dx%d" % (SIDE, SIDE), "--backend", "cpu", "--threads", 1)
    report, _ = machine.render("passes.png", path, "--method", "points", *size)
    points = report["primitives"]["points"]
    for what, paper in PASSES:
        table.row("the paper: %s" % what, paper)
    speeds = {}
    for what, how in (("points as discs, with depth only one by one (points)", ("--method", "points")),
                      ("a pixel a point, with its number, and the pyramid (Gaussian)",
                       ("--method", "pullpush", "--reconstruction", "gaussian")),
                      ("Gaussian discs, two passes (refined)", ("--method", "pullpush"))):
        seconds = machine.seconds_a_frame(5, path, *how, *size)
        speeds[what] = Number(points / seconds.value / 1e6, seconds.command)
        table.row("ours, one thread: %s" % what, speeds[what])
    fast, slow = list(speeds.values())[1:]
    table.judge("yes" if ratio(fast, slow) > 1.5 else "partly",
                "A point of one pixel is %.2g times as fast as a filtered disc (the paper: 8): frames of the whole picture are "
                "timed here, not passes." % ratio(fast, slow))


def tables(machine):
    clouds = Clouds(machine, Volumes(machine))
    yield (Table("2004-table-1", 2004, "Table 1: with and without the selection of points",
                 ["frames/s without", "% of the points culled", "frames/s with"],
                 "Ours: %d × %d pixels for single objects, 1024 × 1024 and one thread for the forest, whose trees are heads of "
                 "our generator. Culled: not drawn, because they face away or are hidden." % (SIDE, SIDE)),
           lambda table: table_1(machine, clouds, table))
    yield (Table("2004-table-2", 2004, "Table 2: millions of points a second", ["million points/s"],
                 "The points of the head at 1024³."), lambda table: table_2(machine, clouds, table))
    yield (Table("2004-figure-3", 2004, "Figure 3: holes without the second visibility pass", ["-"],
                 "The gl engine has none of the paper's passes yet, and the cpu engine needs none of them."),
           lambda table: table.judge("not measured", "The passes of the paper, which need the frame before, are not implemented."))
