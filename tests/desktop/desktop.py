#!/usr/bin/env python3
"""What desktops read (apps/desktop) is valid, knows every type of file, and makes thumbnails where there is neither a display nor a
network and little memory.

usage: desktop.py ROOT [BIN]     (BIN: the folder of the programs, which make thumbnails)

Checks that need a tool which is not installed are left out with a message; without bubblewrap, or where it may not make
namespaces, thumbnails are made without it."""
import array
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as xml
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "rules"))
from file_types import types  # noqa: E402

SYSTEM = Path("/usr/share/mime/packages/freedesktop.org.xml")
NAME = "{http://www.freedesktop.org/standards/shared-mime-info}"
# Of pairs of files; without a header: names that too many other kinds of files have.
NOT_OURS = {".hdr", ".hdr.gz", ".img", ".img.gz", ".asc", ".raw"}
MEMORY = 256 << 20
SIZE = 512
# Runs a command, and says what it took; what made the sandbox is not counted.
MEASURE = """import resource, subprocess, sys
status = subprocess.run(sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss / 1000)
sys.exit(status)"""


def tool_says(failures, tool, *arguments):
    """Runs a checker; what it says is a failure unless it succeeds in silence or says that all is well."""
    if not shutil.which(tool):
        print("not checked: %s is not installed" % tool)
        return
    done = subprocess.run([tool, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode or "hint:" in done.stdout or "warning:" in done.stdout:
        failures.append("%s: %s" % (tool, done.stdout.strip()))


def globs(file):
    """The patterns of a description of types, and what they stand for."""
    for kind in xml.parse(file).getroot().findall(NAME + "mime-type"):
        for pattern in kind.findall(NAME + "glob"):
            yield pattern.get("pattern"), kind.get("type")


def check_types(failures, root, ours):
    """Every extension of the registry is a type's, by us or by shared-mime-info, and what entries name is one of these."""
    if not SYSTEM.exists():
        print("not checked: shared-mime-info is not installed")
        return
    known = dict(list(globs(SYSTEM)) + list(globs(ours)))
    for _, extensions, _ in types(root):
        for extension in extensions:
            if "*" + extension not in known and extension not in NOT_OURS:
                failures.append("%s: no type has the extension %s of src/base/file_types.inc" % (ours, extension))
    for pattern, kind in globs(ours):
        if not any(pattern[1:] in extensions for _, extensions, _ in types(root)):
            failures.append("%s: src/base/file_types.inc does not know %s of %s" % (ours, pattern, kind))
    for name in "isosculpt.desktop", "isopoint.thumbnailer":
        text = (ours.parent / name).read_text(encoding="utf-8")
        for kind in re.search(r"^MimeType=(.*);$", text, re.M)[1].split(";"):
            if kind not in known.values():
                failures.append("%s: nobody knows the type %s" % (name, kind))
    with tempfile.TemporaryDirectory() as folder:
        os.mkdir(folder + "/packages")
        shutil.copy(ours, folder + "/packages")
        done = subprocess.run(["update-mime-database", folder], capture_output=True, text=True)
        if done.returncode or "rror" in done.stderr:
            failures.append("update-mime-database: " + done.stderr.strip())


def sandbox(programs):
    """The command before the command that makes a thumbnail, as a desktop's: nothing but /usr and the programs, no network, its own /tmp."""
    there = ["bwrap", "--unshare-all", "--die-with-parent", "--new-session", "--clearenv", "--ro-bind", "/usr", "/usr",
             "--ro-bind-try", "/etc/ld.so.cache", "/etc/ld.so.cache", "--ro-bind-try", "/etc/alternatives", "/etc/alternatives",
             "--proc", "/proc", "--dev", "/dev", "--tmpfs", "/tmp"]
    for name in "bin", "lib", "lib64":
        there += ["--symlink", "usr/" + name, "/" + name]
    there += ["--ro-bind", str(programs.parent), "/made", "--setenv", "PATH", "/made/bin:/usr/bin"]
    if not shutil.which("bwrap"):
        print("bubblewrap is not installed: thumbnails are made without a sandbox")
        return None
    done = subprocess.run(there + ["true"], capture_output=True, text=True)
    if done.returncode:
        print("bubblewrap cannot work here (%s): thumbnails are made without a sandbox" % done.stderr.strip())
        return None
    return there


def thumbnail(failures, programs, command, source, pixels, folder):
    """Makes a thumbnail as a desktop does, within MEMORY and the pages of its file, which are the system's."""
    out = Path(folder, "out")
    out.mkdir(exist_ok=True)
    picture = out / "thumbnail.png"
    picture.unlink(missing_ok=True)
    before = sandbox(programs)
    words = {"%i": str(source), "%o": str(picture), "%s": str(pixels)}
    if before:
        words.update({"%i": "/tmp/source" + "".join(source.suffixes), "%o": "/tmp/out/thumbnail.png"})
        before += ["--ro-bind", str(source), words["%i"], "--bind", str(out), "/tmp/out"]
    arguments = [re.sub("%[ios]", lambda found: words[found[0]], word) for word in shlex.split(command)]
    began = time.monotonic()
    done = subprocess.run([*(before or []), "/usr/bin/python3", "-c", MEASURE, *arguments], capture_output=True, text=True,
                          env=dict(PATH="%s:%s" % (programs, os.environ["PATH"])))
    took = time.monotonic() - began
    if done.returncode or not picture.exists():
        failures.append("no thumbnail of %s: %s" % (source.name, done.stderr.strip()))
        return
    header = picture.read_bytes()[:24]
    size = int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")
    if size != (pixels, pixels) or done.stdout.count("\n") != 1 or done.stderr:
        failures.append("the thumbnail of %s has %s pixels, and isorender said: %s%s" % (source.name, size, done.stdout, done.stderr))
        return
    seconds, megabytes = map(float, done.stdout.split())
    if megabytes > (MEMORY + source.stat().st_size) / 1e6:
        failures.append("the thumbnail of %s took %d MB" % (source.name, megabytes))
    print("%s: %.2f s, %.2f s of the processors, at most %d MB with the pages of its file" % (source.name, took, seconds, megabytes))


def write_volume(path):
    """SIZE^3 voxels of two bytes, 256 MB: a chessboard, whose surface takes more than MEMORY if it is not drawn in parts."""
    row = [array.array("H", (200 * ((x // 32 + odd) % 2) for x in range(SIZE))).tobytes() for odd in (0, 1)]
    plane = [b"".join(row[(y // 32 + odd) % 2] for y in range(SIZE)) for odd in (0, 1)]
    with open(path, "wb") as file:
        file.write(b"NRRD0004\ntype: uint16\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n\n" % (SIZE, SIZE, SIZE))
        for z in range(SIZE):
            file.write(plane[z // 32 % 2])


def make_thumbnails(failures, programs, root, command):
    with tempfile.TemporaryDirectory() as folder:
        thumbnail(failures, programs, command, root / "volumes/stent.nrrd", 256, folder)
        thumbnail(failures, programs, command, root / "volumes/bear.strokes", 128, folder)
        large = Path(folder, "large.nrrd")
        write_volume(large)
        thumbnail(failures, programs, command, large, 256, folder)


def main():
    root = Path(sys.argv[1]).resolve()
    files = root / "apps/desktop"
    failures = []
    tool_says(failures, "desktop-file-validate", str(files / "isosculpt.desktop"))
    tool_says(failures, "appstreamcli", "validate", "--no-net", "--pedantic", str(files / "isosculpt.metainfo.xml"))
    check_types(failures, root, files / "isopoint.xml")
    version = ".".join(re.findall(r"#define ISO_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", (root / "src/isopoint.h").read_text()))
    for name, pattern in ("apps/desktop/isosculpt.metainfo.xml", r'<release version="([^"]*)"'), ("debian/changelog", r"isopoint \((.*?)\)"):
        if re.search(pattern, (root / name).read_text(encoding="utf-8"))[1] != version:
            failures.append("%s: its newest version is not %s of src/isopoint.h" % (name, version))
    command = re.search(r"^Exec=(.*)$", (files / "isopoint.thumbnailer").read_text(encoding="utf-8"), re.M)[1]
    if len(sys.argv) > 2:
        make_thumbnails(failures, Path(sys.argv[2]).resolve(), root, command)
    if failures:
        sys.exit("\n".join(failures))


if __name__ == "__main__":
    main()
