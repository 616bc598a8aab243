#!/usr/bin/env python3
"""The folders of src include each other in one direction: no circle of folders, however deep they lie.

usage: circles.py ROOT
"""
import re
import sys
from pathlib import Path


def includes(root):
    """The folder of each file of src with the folder of each file that it includes, and the line that does."""
    for path in sorted((root / "src").rglob("*")):
        if path.suffix not in (".c", ".h", ".cc", ".hpp", ".inc"):
            continue
        folder = path.parent.relative_to(root / "src").as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = re.match(r'\s*#\s*include\s+"(.+)/[^/"]+"', line)
            if found and found[1] != folder and (root / "src" / found[1]).is_dir():
                yield folder, found[1], "src/%s:%d: %s" % (path.relative_to(root / "src"), number, line.strip())


def reached(start, arrows):
    """The folders that files of `start` include, directly or through others."""
    seen, waiting = set(), [start]
    while waiting:
        for target in arrows.get(waiting.pop(), ()):
            if target not in seen:
                seen.add(target)
                waiting.append(target)
    return seen


def main():
    arrows, lines = {}, {}
    for folder, target, line in includes(Path(sys.argv[1])):
        arrows.setdefault(folder, set()).add(target)
        lines.setdefault((folder, target), []).append(line)
    if not lines:
        sys.exit("no include was found: nothing was checked")
    reach = {folder: reached(folder, arrows) for folder in arrows}
    bad = [(folder, target) for folder, target in sorted(lines) if folder in reach.get(target, ())]
    for folder, target in bad:
        print("%s includes %s, which leads back to it:" % (folder, target))
        for line in lines[folder, target]:
            print("    " + line)
    if bad:
        sys.exit("%d of %d arrows between folders lie on a circle" % (len(bad), len(lines)))
    print("%d arrows between folders, no circle" % len(lines))


if __name__ == "__main__":
    main()
