"""Tables of the page: rows of numbers, each with the command that measured it, pictures and claims.

A claim is what the paper says, with a threshold that its own numbers give, and stands in these sources before anything is
measured; the numbers decide whether it holds. Where a paper shows pictures only, 30 dB is "hardly visible"."""
import datetime
import math
import os
import time

from measure import Failed, Number

HARDLY_VISIBLE = 30  # dB


class Table:
    """One table or figure of a paper. Columns: the paper's number first, then ours."""

    def __init__(self, name, paper, title, columns, text):
        self.name, self.paper, self.title, self.columns, self.text = name, paper, title, columns, text
        self.rows, self.pictures, self.claims, self.remark = [], [], [], ""
        self.seconds, self.date, self.load = 0.0, "", 0.0

    def row(self, what, *cells):
        """A cell is the paper's plain number, a Number, or None."""
        assert len(cells) == len(self.columns), what
        self.rows.append((what, [cell if isinstance(cell, Number) or cell is None else Number(cell, None)
                                 for cell in cells]))

    def picture(self, path, caption, command):
        self.pictures.append((path, caption, command))

    def claim(self, text, holds, found):
        """The paper's claim, whether it holds, and what was found: a text with the numbers that decide."""
        self.claims.append((text, bool(holds), found))

    def holds(self):
        """All claims of the table hold, some do, or none does."""
        held = [holds for _, holds, _ in self.claims]
        return "not measured" if not held else "yes" if all(held) else "partly" if any(held) else "no"

    def json(self):
        return {
            "name": self.name, "paper": self.paper, "title": self.title, "text": self.text, "columns": self.columns,
            "rows": [{"what": what,
                      "cells": [None if cell is None or cell.value is None else cell_json(cell) for cell in cells]} for what, cells in self.rows],
            "pictures": [{"file": path, "caption": caption, "command": command}
                         for path, caption, command in self.pictures],
            "holds": self.holds(), "remark": self.remark,
            "claims": [{"claim": text, "holds": holds, "found": found} for text, holds, found in self.claims], "seconds": round(self.seconds, 1), "date": self.date,
            "load": round(self.load, 1)}


def cell_json(cell):
    found = {"value": number_json(cell.value), "extremes": cell.extremes, "command": cell.command}
    return {name: value for name, value in found.items() if value is not None}


def number_json(value):
    """Rounded to four digits, so that the files say what the page says; infinity, of equal pictures, is a word."""
    if math.isinf(value):
        return "inf"
    return value if isinstance(value, int) else float("%.4g" % value)


def rate(seconds):
    """Frames a second from a Number of seconds."""
    return None if seconds is None else Number(1 / seconds.value, seconds.command)


def ratio(above, below):
    """The quotient of two Numbers' values."""
    return above.value / below.value


def measure(table, fill):
    """Fills a table; a program that fails, or a file that is missing, is the table's remark."""
    start, table.date, table.load = time.monotonic(), datetime.date.today().isoformat(), os.getloadavg()[0]
    try:
        fill(table)
    except (Failed, OSError, KeyError) as problem:
        table.claims, table.remark = [], "%s." % str(problem).rstrip(".")
    table.seconds = time.monotonic() - start
    return table
