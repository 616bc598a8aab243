#!/usr/bin/env python3
"""Which headers of the library the programs include.

The aim is none but those of base/ and scene/, beside the public header: what a scene can do is done there once,
for the programs and for whoever links the library. HEADERS lists what is left, with the folders of apps that
include it. The list only gets shorter: a header or folder that is not in it fails, and so does one that is no
longer needed. What a program needs and a scene lacks belongs into src/scene.

usage: programs.py ROOT
"""
import re
import sys
from pathlib import Path

OPEN = ("apps", "base", "scene")
# A part of the library that one program is the face of, and that includes the scene as programs do: isocompare's
# studies look into every method and measure what its parts cost, which is no operation of a scene.
OWN = {"compare": "isocompare"}

HEADERS = """
exact/layers.h                       isosculpt
extract/points/points.h              isosculpt
grids/brick_index.h                  common isosculpt page
grids/closing/closed_mesh.h          isosculpt
grids/grid.h                         isosculpt
grids/hgrid.h                        isosculpt
grids/kept.h                         common
grids/rgrid.h                        isosculpt
grids/volume/module.h                isorender mpi
grids/volume_index.h                 isorender
image/camera.h                       isosculpt
image/image.h                        common
io/chunk_export.h                    isorender
io/file_contents.h                   isorender isosculpt
io/glyphs/placements_read.h          isorender
io/key_file.h                        isorender
io/mesh/mesh_write.h                 isosculpt
render/gl/canvas.h                   isosculpt
render/layers/opacity.h              isosculpt
render/shading/outline.h             isosculpt
render/shading/shading.h             isosculpt
sculpt/brush/brush.h                 isosculpt
sculpt/brush/dab.h                   isosculpt
sculpt/session/session.h             isosculpt
source/label.h                       isosculpt
source/source.h                      isosculpt
"""


def included(root):
    """Each private header that programs include, with the folders of apps that do."""
    found = {}
    for path in sorted((root / "apps").rglob("*")):
        if path.suffix not in (".c", ".h", ".cc", ".hpp", ".inc"):
            continue
        folder = path.relative_to(root / "apps").parts[0]
        for header in re.findall(r'^\s*#\s*include\s+"(.+)/([^/"]+)"', path.read_text(encoding="utf-8"), re.M):
            top = header[0].split("/")[0]
            if top not in OPEN and OWN.get(top) != folder:
                found.setdefault("/".join(header), set()).add(folder)
    return found


def main():
    found = included(Path(sys.argv[1]))
    listed = {row.split()[0]: set(row.split()[1:]) for row in HEADERS.strip().splitlines()}
    if not found or not listed:
        sys.exit("no include, or no row, was found: nothing was checked")
    bad = []
    for header in sorted(found.keys() | listed.keys()):
        now, before = found.get(header, set()), listed.get(header, set())
        bad += ["%s: new in apps/%s" % (header, folder) for folder in sorted(now - before)]
        bad += ["%s: apps/%s needs it no longer: take it off the list" % (header, folder)
                for folder in sorted(before - now)]
    for line in bad:
        print(line)
    if bad:
        sys.exit("programs include what tests/rules/programs.py does not list, or less")
    print("programs include %d private headers, in %d places" % (len(found), sum(map(len, found.values()))))


if __name__ == "__main__":
    main()
