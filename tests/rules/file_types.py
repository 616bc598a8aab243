#!/usr/bin/env python3
"""The extensions of files stand in one list, src/base/file_types.inc: no other source lists them, and the pages, the public header
and the help name what the list has.

usage: file_types.py ROOT FOLDER-OF-PROGRAMS
"""
import re
import subprocess
import sys
from pathlib import Path

# The names that a program gives to files that it writes: one each, no lists.
GIVEN = {
    ("apps/isocompare/options.c", ".json"), ("apps/isorender/options.c", ".json"), ("apps/isosculpt/options.c", ".json"),
    ("apps/isosculpt/document.c", ".strokes"), ("apps/isosculpt/save.c", ".vdb"),
    ("apps/isosculpt/window/panel.cc", ".stl"),
    ("apps/isosculpt/window/panel.cc", ".png")}
OF_PAIRS = {"grids/volume/format_nifti.c"}  # the header and the voxels of one volume, NAME.hdr and NAME.img


def types(root):
    """The rows of the list: (name, extensions, handlers)."""
    text = (root / "src/base/file_types.inc").read_text(encoding="utf-8")
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    rows = re.findall(r"^FILE_TYPE\((\w+),\s*\"([^\"]*)\",(.*?)\)$", text, re.M | re.S)
    for name, extensions, rest in rows:
        yield name, extensions.split(), set(re.findall(r"\b[A-Z_]{3,}\b", re.sub(r'"[^"]*"', "", rest)))


def other_lists(root, known):
    for folder in ("src", "grids", "apps"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".c", ".h", ".cc", ".hpp", ".inc") or path.name == "file_types.inc":
                continue
            name = path.relative_to(root).as_posix()
            text = path.read_text(encoding="utf-8")
            for literal in re.findall(r'"(\.[a-z0-9.]+)"', re.sub(r"/\*.*?\*/", "", text, flags=re.S)):
                if literal in known and (name, literal) not in GIVEN and name not in OF_PAIRS:
                    yield "%s: \"%s\" is said in src/base/file_types.inc: look types up by base/file_types.h" % (name, literal)


def missing(where, text, extensions):
    for extension in extensions:
        if not re.search(re.escape(extension) + r"(?![a-z0-9])", text):
            yield "%s does not name %s" % (where, extension)


def main():
    root, programs = Path(sys.argv[1]), Path(sys.argv[2])
    rows = list(types(root))
    if len(rows) < 30:
        sys.exit("%d rows were found in the list: nothing was checked" % len(rows))
    known = {extension for _, extensions, _ in rows for extension in extensions}
    bad = list(other_lists(root, known))
    shapes = {"MESH", "LINES", "GLYPHS"}
    data = shapes | {"VOLUME"}

    def of(kinds, all_of_them=False):
        return [e for _, extensions, handlers in rows if handlers & kinds
                for e in (extensions if all_of_them else extensions[:1])]

    page = (root / "docs/formats.md").read_text(encoding="utf-8")
    header = (root / "src/isopoint.h").read_text(encoding="utf-8")
    bad += missing("docs/formats.md", page, of(data | {"STROKES"}, True))
    bad += missing("src/isopoint.h", header, of({"LINES", "GLYPHS", "WRITE_MESH"}))
    for program, kinds in (("isorender", data), ("isosculpt", {"MESH", "LINES", "POINTS"})):
        text = subprocess.run([programs / program, "--help", "all"], stdout=subprocess.PIPE, check=True, text=True).stdout
        bad += missing(program + " --help all", text, of(kinds))
    if bad:
        sys.exit("\n".join(bad))
    print("%d types of files, %d extensions" % (len(rows), len(known)))


if __name__ == "__main__":
    main()
