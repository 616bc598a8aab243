#!/usr/bin/env python3
"""Pages in a browser: what they show are the bytes of isorender, after a drag, a zoom and a new isovalue, without a network.

usage: page.py FOLDER-OF-PROGRAMS ROOT [CASE ...]     exit status 77: skipped
"""
import base64
import math
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cli"))
sys.path.insert(0, str(Path(__file__).resolve().parent))
from browser import Browser, require  # noqa: E402
from check import Png  # noqa: E402

SHOT = """const c = document.getElementById('canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
let t = ''; for (let i = 0; i < d.length; i += 8192) t += String.fromCharCode(...d.subarray(i, i + 8192)); return btoa(t);"""
programs, root = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
failures = []


def expect(condition, *words):
    if not condition:
        failures.append(" ".join(map(str, words)))
        print("FAILED:", *words)


def isorender(*words, cwd=None):
    result = subprocess.run([str(programs / "isorender"), *map(str, words)], capture_output=True, text=True, check=False, cwd=cwd)
    expect(result.returncode == 0, "isorender", *words, result.stderr)
    return result.stderr


def nrrd(path, kind, size, header, voxels):
    lines = ["NRRD0004", "type: " + kind, "dimension: 3", "sizes: %d %d %d" % size, "endian: little", "encoding: raw", *header, "", ""]
    path.write_bytes("\n".join(lines).encode() + voxels)


def floats_with_nan(path):
    """Floats with NaN, infinities and denormals among them."""
    n, values = 24, []
    for i in range(n ** 3):
        x, y, z = i % n - 11.3, i // n % n - 12.1, i // n // n - 11.7
        value = 80 - x * x - .7 * y * y - z * z + 12 * ((i * 2654435761 >> 7) % 97) / 97
        values.append({0: float("nan"), 1: float("inf"), 2: -float("inf"), 3: 1e-41}.get(i * 48271 % 2147483647 % 400, value))
    nrrd(path, "float", (n, n, n), ["space: left-posterior-superior", "space directions: (1,0,0) (0,1,0) (0,0,1)",
                                    "space origin: (0,0,0)"], struct.pack("<%df" % n ** 3, *values))


def oblique(path):
    """An oblique volume with voxels of three lengths."""
    n, values = (30, 26, 20), []
    for i in range(n[0] * n[1] * n[2]):
        x, y, z = i % n[0] - 14.2, i // n[0] % n[1] - 12.6, i // n[0] // n[1] - 9.4
        values.append(int(1500 - 6 * x * x - 7 * y * y - 11 * z * z + (i * 40503 >> 4) % 37))
    nrrd(path, "short", n, ["space: left-posterior-superior", "space directions: (.9,.2,.1) (-.3,1.1,.25) (.05,-.4,1.7)",
                            "space origin: (12.5,-30.25,101)"], struct.pack("<%dh" % len(values), *values))


def segmentation(path):
    """Labels: a block, a ball in it, an oblique sheet, and a label that is not drawn; and names of them."""
    n, values = (30, 26, 20), []
    for i in range(n[0] * n[1] * n[2]):
        x, y, z = i % n[0] - 14.2, i // n[0] % n[1] - 12.6, i // n[0] // n[1] - 9.4
        ball = x * x + y * y + z * z < 25
        values.append(7 if ball else 300 if abs(2 * x - y + z - 20) < 2 else 12 if max(abs(x), abs(y), abs(z)) < 8 else 40 if z > 7 else 0)
    nrrd(path, "ushort", n, ["space: left-posterior-superior", "space directions: (.9,.2,.1) (-.3,1.1,.25) (.05,-.4,1.7)",
                             "space origin: (12.5,-30.25,101)"], struct.pack("<%dH" % len(values), *values))
    path.with_suffix(".ctbl").write_text("7 the <b>ball</b> 220 40 40 255\n12 block 40 90 220 255\n300 sheet 40 200 90 255\n40 secret 1 2 3 255\n")


def spirals(path, radius=14, turns=3):
    """Lines as a VTK file, with a column of numbers."""
    points, lines, numbers = [], [], []
    for k in range(5):
        lines.append(range(len(points), len(points) + 60))
        for i in range(60):
            t, r = i / 59, radius * (.4 + .12 * k)
            points.append((12 + r * math.cos(6.28 * turns * t + k), -30 + r * math.sin(6.28 * turns * t + k), 85 + 32 * t))
            numbers.append(i + 10 * k)
    path.write_text("# vtk DataFile Version 3.0\nspirals\nASCII\nDATASET POLYDATA\nPOINTS %d float\n%s\nLINES %d %d\n%s\nPOINT_DATA %d\n"
                    "SCALARS heat float 1\nLOOKUP_TABLE default\n%s\n" % (
                        len(points), "\n".join("%.5f %.5f %.5f" % p for p in points), len(lines), sum(len(l) + 1 for l in lines),
                        "\n".join("%d %s" % (len(l), " ".join(map(str, l))) for l in lines), len(points), "\n".join(map(str, numbers))))


def rest(browser, what):
    """Waits for the last of the pictures that follow a movement."""
    if not browser.wait("window.isopoint && (isopoint.samples === 16 || isopoint.failed)"):
        expect(False, what, "never came to rest:", browser.run("return document.getElementById('say').textContent"))
        return False
    failed = browser.run("return isopoint.failed || ''")
    expect(not failed, what, failed)
    return not failed


def same(browser, source, work, what):
    """Whether the canvas shows what the page's command draws."""
    if not rest(browser, what):
        return
    command = browser.run("return isopoint.command()")
    words = shlex.split(command)
    out = work / "native.png"
    at = 2 if source else 1
    expect(words[0] == "isorender" and (not source or words[1] == Path(source).name), what, "the command is", command)
    isorender(*[source] * (source is not None), out, *words[at + 1:], cwd=work)
    canvas = base64.b64decode(browser.run(SHOT))
    png = Png(str(out))
    native = b"".join(bytes(v for pixel in row for v in pixel) for row in png.rows)
    width, height = browser.run("const c = document.getElementById('canvas'); return [c.width, c.height]")
    expect((width, height) == (png.width, png.height), what, "sizes", width, height, png.width, png.height)
    wrong = sum(a != b for a, b in zip(canvas, native)) if len(canvas) == len(native) else -1
    shown = sum(canvas[i:i + 3] != canvas[:3] for i in range(0, len(canvas), 4)) / max(1, len(canvas) // 4)
    expect(wrong == 0, what, wrong, "bytes differ:", command)
    expect(.02 < shown < .98, what, "shows", shown)
    print("%s: %dx%d, %d bytes differ, %.0f %% shown" % (what, width, height, wrong, 100 * shown))


def case(work, name, source, *options, isovalue=None, cut=None, legend=None):
    page = work / (name + ".html")
    isorender(*[source] * (source is not None), page, *options, cwd=work)
    with Browser(620, 560) as browser:
        began = time.monotonic()
        browser.open(str(page))
        same(browser, source, work, name + ", first")
        ready = time.monotonic() - began
        browser.drag([(300, 280), (330, 290), (380, 250)])
        same(browser, source, work, name + ", dragged")
        browser.wheel(300, 280, 90)
        browser.drag([(300, 280), (320, 260)], button=2)
        same(browser, source, work, name + ", zoomed and moved")
        slide = "const s = document.getElementById('slider0'); s.value = +s.min + .7 * (s.max - s.min); s.dispatchEvent(new Event('input'));"
        if browser.run("return !!document.getElementById('slider0')"):
            browser.run(slide if isovalue is None else "const n = document.getElementById('number0'); n.value = %r; "
                        "n.dispatchEvent(new Event('change'));" % isovalue)
            same(browser, source, work, name + ", another isovalue")
        if cut:
            browser.run(slide.replace("slider0", "cut").replace(".7", str(cut)))
            same(browser, source, work, name + ", another cut")
        if legend:
            shown = browser.run("return [...document.querySelectorAll('#legend li')].map(e => e.textContent + ' ' + e.firstChild.style.background)")
            expect(shown == legend and browser.run("return document.getElementById('legend').clientHeight > 20"), name, "the legend is", shown)
        expect(not [u for u in browser.requests() if not u.startswith(("file://" + str(page), "blob:", "data:"))], name, "asked the network")
        errors = [e["message"] for e in browser.log("browser") if e["level"] == "SEVERE"]
        expect(not errors, name, errors)
        print("%s: ready and at rest after %.1f s, %d pictures" % (name, ready, browser.run("return isopoint.frames")))


CAMERA = "return isopoint.drawn.camera"


def controls(work):
    """Keys, pinch, Home, the buttons and what is said to those who do not see."""
    page = work / "controls.html"
    isorender("scene:ct:48", page, "--isovalue=130")
    with Browser(620, 560) as browser:
        browser.open(str(page))
        rest(browser, "controls")
        first = browser.run(CAMERA)

        def changed(what, at_least=1e-9):
            rest(browser, what)
            now = browser.run(CAMERA)
            expect(max(abs(a - b) for a, b in zip(first, now)) > at_least, what, "changed nothing")
            return now
        browser.run("document.getElementById('canvas').focus()")
        browser.keys("\ue014")  # the right arrow
        turned = changed("the right arrow")
        expect(turned[9] == first[9] and turned[3:6] == first[3:6], "an arrow turns only")
        browser.keys("\ue011")
        rest(browser, "Home")
        expect(browser.run(CAMERA) == first, "Home gives the first camera back")
        browser.keys("++")
        expect(changed("plus")[9] < first[9], "plus enlarges")
        browser.run("document.getElementById('reset').click()")
        rest(browser, "reset")
        expect(browser.run(CAMERA) == first, "the button resets")
        browser.pinch(300, 260, 30, 90)
        expect(changed("a pinch")[9] < .5 * first[9], "a pinch enlarges")
        browser.run("document.getElementById('canvas').focus()")
        browser.keys("]")
        rest(browser, "]")
        value = browser.run("return isopoint.drawn.isovalues[0]")
        low, high = browser.run("const s = document.getElementById('slider0'); return [+s.min, +s.max]")
        expect(abs(value - 130 - (high - low) / 100) < 1e-6 and low < 130 < high, "] changes the isovalue", value, low, high)
        expect(str(value) in browser.run("return document.getElementById('canvas').getAttribute('aria-label')"), "the label names the isovalue")
        unlabelled = browser.run("""return [...document.querySelectorAll('input, button, canvas')].filter(e => !e.hidden && !e.labels?.length &&
            !e.getAttribute('aria-label') && !e.textContent).map(e => e.outerHTML)""")
        expect(not unlabelled, "without a label:", unlabelled)
        browser.run("window.saved = null; URL.createObjectURL = blob => { window.saved = blob; return 'blob:'; }; document.getElementById('save').click()")
        expect(browser.wait("window.saved && saved.type === 'image/png' && saved.size > 1000", 10), "Save PNG saves none")
        print("controls: done")


def fine(work):
    """Moving pictures of many cells are of every second voxel, and the one at rest is not."""
    page = work / "fine.html"
    isorender("scene:ct:96", page, "--isovalue=130", "--isovalue-range=120,140")
    with Browser(620, 560) as browser:
        browser.open(str(page))
        rest(browser, "fine")
        browser.run("isopoint.halfCells = 1000")
        browser.drag([(300, 280), (330, 290), (380, 250)])
        rest(browser, "fine, dragged")
        halves, frames = browser.run("return [isopoint.halves, isopoint.frames]")
        expect(0 < halves < frames, "fine:", halves, "of", frames, "pictures were of every second voxel")
        same(browser, "scene:ct:96", work, "fine, after %d pictures of half the volume" % halves)


def report(work):
    """The page within a report of isocompare."""
    subprocess.run([str(programs / "isocompare"), "report", "scene:ct:32", "--isovalue=130", "--side=64", "--quiet",
                    "--output=%s" % (work / "report")], check=True)
    with Browser(1000, 800) as browser:
        browser.open(str(work / "report" / "report.html"))
        inner = "document.querySelector('iframe').contentWindow"
        expect(browser.wait(inner + ".isopoint?.samples === 16"), "the report's page never came to rest")
        expect(browser.run("return %s.document.getElementById('copy').hidden" % inner), "a command that is not known is offered")
        print("report: done")


def stills(work):
    """Where something is missing the first picture stays, and it is said what."""
    page = work / "still.html"
    isorender("scene:ct:48", page, "--isovalue=130")
    seen = "return [getComputedStyle(document.getElementById('still')).display !== 'none', document.getElementById('say').textContent]"
    for what, script, reason in (("SIMD", "WebAssembly.validate = () => false", "no WebAssembly with SIMD"),
                                 ("WebAssembly", "delete window.WebAssembly", "no WebAssembly"),
                                 ("unpacking", "delete window.DecompressionStream", "cannot unpack"),
                                 ("workers", "window.Worker = class { constructor() { throw new Error('workers are forbidden') } }", "forbidden"),
                                 ("scripts", None, "scripts of the page, which turn the surface, have not run")):
        with Browser(620, 560) as browser:
            if script:
                browser.before_scripts(script)
            else:
                browser.without_scripts()
            browser.open(str(page))
            if script:
                expect(browser.wait("window.isopoint && isopoint.failed", 20), "without", what, "nothing fails")
            shown, said = browser.run(seen)
            expect(shown and said.startswith("This is a still picture") and reason in said, "without", what, shown, said)
            print("without %s: %s" % (what, said))


def cases(work):
    yield "controls", lambda: controls(work)
    yield "stills", lambda: stills(work)
    yield "fine", lambda: fine(work)
    yield "report", lambda: report(work)
    stent = root / "../shared/volumes/stent/stent.nrrd"
    if stent.exists():
        yield "stent", lambda: case(work, "stent", stent, "--isovalue=600", "--isovalue-range=400,800")
    yield "ct", lambda: case(work, "ct", "scene:ct:256", "--isovalue=130", "--isovalue-range=100,160", isovalue=112.5)

    def nan():
        floats_with_nan(work / "nan.nrrd")
        case(work, "nan", work / "nan.nrrd", "--isovalue=31.7")
    yield "nan", nan

    def slanted():
        oblique(work / "oblique.nrrd")
        case(work, "oblique", work / "oblique.nrrd", "--isovalue=700", "--orthographic", "--color=gold", "--background=202830")
    yield "oblique", slanted

    def layers():
        oblique(work / "layers.nrrd")
        case(work, "layers", work / "layers.nrrd", "--isovalue=300,900", "--opacity=.3,1", "--color=gold,808090")
    yield "layers", layers

    legend = ["the <b>ball</b> rgb(220, 40, 40)", "block rgb(40, 90, 220)", "sheet rgb(40, 200, 90)"]
    drawn = ["--label-table=tables/seg.ctbl", "--label=all,40:0,block:.4"]

    def labels():
        segmentation(work / "seg.nrrd")
        (work / "tables").mkdir()
        shutil.copy(work / "seg.ctbl", work / "tables")
        case(work, "labels", None, "--labels=seg.nrrd", *drawn, legend=legend)
        text = (work / "labels.html").read_text()
        expect("secret" not in text and "tables" not in text, "the name of a label that is not drawn, or a folder, is in the page")
    yield "labels", labels

    def labels_cut():
        segmentation(work / "seg.nrrd")
        case(work, "labels_cut", work / "seg.nrrd", "--smooth", "--label=7,12,300", "--clip=14,-25,120:1,2,-.3", "--cap=surface", cut=.56)
    yield "labels_cut", labels_cut

    def labels_beside():
        oblique(work / "oblique.nrrd")
        segmentation(work / "seg.nrrd")
        case(work, "labels_beside", work / "oblique.nrrd", "--isovalue=300", "--opacity=.3", "--labels=seg.nrrd", "--label=7,300", "--clip=14,-25,120:1,2,-.3",
             "--cap=surface", cut=.56)
    yield "labels_beside", labels_beside

    def lines():
        spirals(work / "tracts.vtk")
        case(work, "lines", None, "--lines=tracts.vtk", "--tube-radius=1.5", "--color-by=heat", "--clip=14,-25,105:1,2,-.3", cut=.4)
    yield "lines", lines

    def lines_beside():
        oblique(work / "oblique.nrrd")
        segmentation(work / "seg.nrrd")
        spirals(work / "tracts.vtk")
        spirals(work / "ribbons.vtk", 20, 1)
        case(work, "lines_beside", work / "oblique.nrrd", "--isovalue=300", "--opacity=.3", "--labels=seg.nrrd", "--label=7,300", "--lines=tracts.vtk",
             "--lines=ribbons.vtk", "--line-style=line", "--line-style=ribbon", "--tube-radius=2", "--line-color=red", "--line-color=teal", "--line-min-pixels=2.5")
        case(work, "lines_translucent", work / "oblique.nrrd", "--isovalue=900", "--lines=tracts.vtk", "--line-opacity=.4", "--tube-radius=1", "--caps=flat")
    yield "lines_beside", lines_beside

    def cut():
        oblique(work / "cut.nrrd")
        case(work, "cut", work / "cut.nrrd", "--isovalue=300,900", "--clip=14,-25,120:1,2,-.3", "--cap=surface", cut=.56)
    yield "cut", cut


def main():
    require()
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        for name, run in cases(work):
            if name in sys.argv[3:] or not sys.argv[3:]:
                run()
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
