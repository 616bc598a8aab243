#!/usr/bin/env python3
"""Runs the code cells of notebooks, and compares the pictures that they show with pictures.tsv: a hash of the pixels of
each. usage: notebooks.py FOLDER [--write]. ROOT: the source, where the notebooks find their volumes."""
import ast
import hashlib
import json
import os
import sys
import time
from pathlib import Path


def shown(cell, space):
    """Runs a cell; returns what its last line is, as a notebook would show it."""
    tree = ast.parse("".join(cell["source"]))
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), space)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), space) if last else None


def pixels(picture):
    import isopoint
    if isinstance(picture, isopoint.Thing):
        picture = picture.render(size=(512, 512))
    return hashlib.sha256(picture.array.tobytes()).hexdigest()[:16]


def main():
    folder, write = Path(sys.argv[1]).resolve(), "--write" in sys.argv
    table = folder / "pictures.tsv"
    wanted = {} if write else dict(line.split("\t") for line in table.read_text().splitlines())
    os.chdir(os.environ.get("ROOT", "."))
    found, bad = {}, 0
    for path in sorted(folder.glob("*.ipynb")):
        cells = [c for c in json.loads(path.read_text())["cells"] if c["cell_type"] == "code"]
        space, begun = {"__name__": "__main__"}, time.monotonic()
        for number, cell in enumerate(cells, 1):
            if cell["outputs"]:
                print(f"{path.name}: cell {number} has outputs, which belong to no repository")
                bad += 1
            picture = shown(cell, space)
            if hasattr(picture, "_repr_png_"):
                found[f"{path.stem} {number}"] = pixels(picture)
        print(f"{path.name}: {len(cells)} cells, {time.monotonic() - begun:.1f} s")
    if write:
        table.write_text("".join(f"{name}\t{value}\n" for name, value in found.items()))
    for name in sorted({*wanted, *found}):
        if not write and wanted.get(name) != found.get(name):
            print(f"{name}: {found.get(name)}, expected {wanted.get(name)}")
            bad += 1
    sys.exit(bad > 0)


main()
