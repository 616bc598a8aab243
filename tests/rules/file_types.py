#!/usr/bin/env python3
"""The extensions of files stand in one list, src/base/file_types.inc: no other source has them, and docs/formats.md has its table.

usage: file_types.py ROOT [--write]     (--write renews the table)
"""
import re
import sys
from pathlib import Path

# The names that a program gives to files that it writes: one each, no lists.
GIVEN = {
    ("apps/isocompare/options.c", ".json"), ("apps/isorender/options.c", ".json"), ("apps/isosculpt/options.c", ".json"),
    ("apps/isosculpt/document.c", ".strokes"), ("apps/isosculpt/save.c", ".vdb"),
    ("apps/isosculpt/window/panel.cc", ".stl"), ("apps/isosculpt/window/panel.cc", ".png")}
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


def table(rows):
    """The lines of docs/formats.md that say which types hold what."""
    kinds = (("volumes", "VOLUME"), ("meshes", "MESH"), ("numbers of vertices", "VALUES"), ("lines", "LINES"), ("glyphs", "GLYPHS"), ("points on surfaces", "POINTS"),
             ("strokes", "STROKES"), ("scenes", "SCENE"), ("key images", "KEYS"), ("pictures, written", "WRITE_IMAGE"), ("videos, written", "WRITE_VIDEO"),
             ("meshes, written", "WRITE_MESH"), ("points, written", "WRITE_POINTS"), ("level sets, written", "WRITE_VOLUME"),
             ("channels, written", "WRITE_CHANNELS"))
    yield "| what | extensions |"
    yield "|---|---|"
    for words, handler in kinds:
        names = [e for _, extensions, handlers in rows if handler in handlers for e in extensions]
        yield "| %s | %s |" % (words, " ".join("`%s`" % name for name in names))


def page_with(text, lines):
    """The page with these lines between its marks."""
    mark = "<!-- written by tests/rules/file_types.py --write -->\n"
    before, mark, after = text.partition(mark)
    if not mark:
        sys.exit("docs/formats.md has no place for the table of types")
    return before + mark + "\n".join(lines) + "\n" + re.sub(r"^(\|.*\n)*", "", after)


def main():
    root = Path(sys.argv[1])
    rows = list(types(root))
    if len(rows) < 30:
        sys.exit("%d rows were found in the list: nothing was checked" % len(rows))
    known = {extension for _, extensions, _ in rows for extension in extensions}
    page = root / "docs/formats.md"
    text = page.read_text(encoding="utf-8")
    wanted = page_with(text, table(rows))
    if "--write" in sys.argv[2:]:
        page.write_text(wanted, encoding="utf-8")
        text = wanted
    bad = list(other_lists(root, known))
    if text != wanted:
        bad.append("docs/formats.md: its table is not that of src/base/file_types.inc: run %s ROOT --write" % sys.argv[0])
    if bad:
        sys.exit("\n".join(bad))
    print("%d types of files, %d extensions" % (len(rows), len(known)))


if __name__ == "__main__":
    main()
