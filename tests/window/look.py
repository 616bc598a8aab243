"""Answers questions about pictures. look.py QUESTION FILE ...: exit status 0 means yes.

modal FILE              a question or the browser: the rest of the window is dark
color FILE R G B BOX N  at least N pixels of about that colour in BOX (X0,Y0,X1,Y1)
box FILE                prints the box around what is not background: X0 Y0 X1 Y1 (X1, Y1 are outside)
smooth FILE BOX         of the places in BOX where a row changes between background and object, half or more have
                        a pixel of a colour between both
same A B N [BOX]        at most N pixels differ (in BOX); prints how many do
near A B N              no channel of a pixel differs by more than N; prints by how much one does
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from check import Png


def is_near(a, b):
    return all(abs(x - y) <= 24 for x, y in zip(a, b))


def modal(path):
    return max(Png(path).row(790)[1270][:3]) < 40


def color(path, r, g, b, box, count):
    x0, y0, x1, y1 = (int(v) for v in box.split(","))
    wanted = (int(r), int(g), int(b))
    png = Png(path)
    found = sum(is_near(pixel[:3], wanted) for y in range(y0, min(y1, png.height)) for pixel in png.row(y)[x0:x1])
    print(found)
    return found >= int(count)


def box(path):
    rows = Png(path).rows
    background = rows[0][-1]
    ys = [y for y, row in enumerate(rows) if any(pixel != background for pixel in row)]
    columns = [x for row in (rows[y] for y in ys) for x, pixel in enumerate(row) if pixel != background]
    print(min(columns, default=0), ys[0] if ys else 0, max(columns, default=-1) + 1, ys[-1] + 1 if ys else 0)
    return bool(ys)


def smooth(path, box):
    x0, y0, x1, y1 = (int(v) for v in box.split(","))
    edges = mixed = 0
    for row in (r[x0:x1] for r in Png(path).rows[y0:y1]):
        background = row[-1][:3]
        at = [x for x, pixel in enumerate(row) if pixel[:3] != background]
        for edge, inner in ((at[0], at[0] + 1), (at[-1], at[-1] - 1)) if len(at) > 8 else ():
            # one sample: the outermost pixel has about the colour of the pixel beside it
            rim, beside = row[edge][:3], row[inner][:3]
            edges += 1
            mixed += max(abs(a - b) for a, b in zip(rim, beside)) > max(abs(a - b) for a, b in zip(background, beside)) / 5
    print(mixed, "of", edges)
    return edges > 100 and 2 * mixed >= edges


def differing_rows(first, second):
    """The numbers of rows of which any pixel may differ."""
    alike = first.channels == second.channels != 1
    return [y for y in range(min(first.height, second.height)) if not alike or first.lines[y] != second.lines[y]]


def same(a, b, count, box="0,0,100000,100000"):
    first, second = Png(a), Png(b)
    x0, y0, x1, y1 = (int(v) for v in box.split(","))
    rows = [y for y in differing_rows(first, second) if y0 <= y < y1]
    differ = sum(p != q for y in rows for p, q in zip(first.row(y)[x0:x1], second.row(y)[x0:x1]))
    print(differ, "pixels differ")
    return (first.width, first.height) == (second.width, second.height) and differ <= int(count)


def near(a, b, most):
    first, second = Png(a), Png(b)
    rows = differing_rows(first, second)
    largest = max((abs(x - y) for i in rows for p, q in zip(first.row(i), second.row(i)) for x, y in zip(p, q)), default=0)
    print("differ by", largest)
    return (first.width, first.height) == (second.width, second.height) and largest <= int(most)


sys.exit(not {"modal": modal, "color": color, "box": box, "smooth": smooth, "same": same, "near": near}[sys.argv[1]](*sys.argv[2:]))
