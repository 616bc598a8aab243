#!/usr/bin/env python3
"""A type or enumerator of a header is defined in that header alone: two meanings of a name confuse readers, and sources that
include both headers cannot be compiled as one unit (tools/unity.cmake).

usage: one_meaning.py ROOT
"""
import collections
import re
import sys
from pathlib import Path


def names(text):
    """Types and enumerators that a header defines."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    for found in re.finditer(r"^(?:typedef )?(?:struct|enum|union) (\w+) \{", text, re.M):
        yield found[1]
    for found in re.finditer(r"^\} (\w+);", text, re.M):
        yield found[1]
    for found in re.finditer(r"^(?:typedef )?enum\b[^{\n]*\{([^}]*)\}", text, re.M):
        yield from re.findall(r"(?:^|,)\s*([A-Z]\w*)", found[1])


def main():
    root = Path(sys.argv[1])
    headers = collections.defaultdict(set)
    for folder in ("src", "grids", "apps"):
        for path in (root / folder).rglob("*.h"):
            for name in names(path.read_text(encoding="utf-8")):
                headers[name].add(path.relative_to(root).as_posix())
    twice = {name: sorted(paths) for name, paths in headers.items() if len(paths) > 1}
    for name, paths in sorted(twice.items()):
        print("%s is defined in %s" % (name, " and in ".join(paths)))
    print("%d names" % len(headers))
    return 1 if twice or len(headers) < 1000 else 0


sys.exit(main())
