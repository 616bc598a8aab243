#!/usr/bin/env python3
"""The README and the pages of docs/ keep to their sizes, and every link in them leads to a file and a heading; the
map of the architecture names every folder.

usage: pages.py ROOT
"""
import re
import sys
from pathlib import Path

README = {"lines": 180, "bytes": 10 * 1024, "columns": 120, "words of a table's cell": 12}
PAGE_LINES = 150
GLOSSARY_ROWS = 130  # what only one folder speaks of is explained in its header
LONG = {"PAPERS.md", "GLOSSARY.md", "claims.md"}  # lists, which are looked up and not read; options-*.md too


def anchors(text):
    """The names by which the headings of a page, and its HTML anchors, can be linked to."""
    names = set(re.findall(r'<a id="([^"]*)"', text))
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        names.add(re.sub(r"[^\w\- ]", "", words).strip().replace(" ", "-"))
    return names


def without_code(text):
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    return re.sub(r"^(    .*)$", "", text, flags=re.M)


def wrong_links(path):
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(path.read_text(encoding="utf-8"))):
        if target.startswith(("http:", "https:")):
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name) if name else path
        if not file.exists():
            yield "%s: a link to %s, which is not there" % (path, target)
        elif anchor and anchor not in anchors(file.read_text(encoding="utf-8")):
            yield "%s: a link to %s, which has no such heading" % (path, target)


def over_budget(path):
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    cells = [cell for line in without_code(text).splitlines() if line.startswith("|") for cell in line.split("|")]
    found = {"lines": len(lines), "bytes": len(text.encode()), "columns": max(map(len, lines)),
             "words of a table's cell": max(len(cell.split()) for cell in cells)}
    for what, most in README.items():
        if found[what] > most:
            yield "%s: %d %s, at most %d" % (path, found[what], what, most)


def unnamed_folders(root):
    """The folders of sources that the map does not name."""
    text = (root / "docs/ARCHITECTURE.md").read_text(encoding="utf-8")
    folders = {path.parent.relative_to(root) for top in ("src", "grids", "apps") for path in (root / top).rglob("*.[ch]*")}
    folders |= {path.parent.relative_to(root) for top in ("tests", "tools") for path in (root / top).glob("*/*")}
    for folder in sorted(folders):
        if "__pycache__" not in folder.parts and "`%s`" % folder not in text and not re.search(r"\b%s/" % re.escape(folder.name), text):
            yield "docs/ARCHITECTURE.md does not name the folder %s" % folder


def main():
    root = Path(sys.argv[1])
    pages = sorted((root / "docs").glob("*.md"))
    bad = [*over_budget(root / "README.md"), *unnamed_folders(root)]
    for page in [root / "README.md", *sorted(root.glob("CONTRIBUTING.md")), *pages]:
        bad += wrong_links(page)
    rows = (root / "docs/GLOSSARY.md").read_text(encoding="utf-8").count("\n| ")
    if rows > GLOSSARY_ROWS:
        bad.append("docs/GLOSSARY.md: %d rows, at most %d" % (rows, GLOSSARY_ROWS))
    for page in pages:
        count = len(page.read_text(encoding="utf-8").splitlines())
        if count > PAGE_LINES and page.name not in LONG and not page.name.startswith("options-"):
            bad.append("%s: %d lines, at most %d" % (page, count, PAGE_LINES))
    print("\n".join(bad) or "%d pages keep to their sizes, and their links lead somewhere" % (len(pages) + 1))
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
