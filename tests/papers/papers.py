#!/usr/bin/env python3
"""Repeats the tables and figures of the five papers on this machine.

usage: papers.py PROGRAMS SOURCE FOLDER [TABLE...]

Writes FOLDER/papers.json and FOLDER/index.html, a page with everything in it. TABLE: only tables whose names
begin so, such as 2003 or 2003-table-2; the others are kept as papers.json has them, and the page says where pictures
of theirs are no longer in the folder."""
import json
import os
import sys

import page
import y2003
import y2004
import y2006
import y2008
import y2010
from measure import Machine, processor
from tables import measure

SCHEMA = "isopoint-papers/3"
PAPERS = (y2003, y2004, y2006, y2008, y2010)


def kept_tables(path):
    """The tables of an earlier run, by name; a file that is not of this schema is none."""
    if not os.path.exists(path):
        return {}
    try:
        with open(path, encoding="utf-8") as file:
            papers = json.load(file)
        return {table["name"]: table for table in papers["tables"]} if papers["schema"] == SCHEMA else {}
    except (ValueError, KeyError, TypeError):
        print("%s: not a file of this program; nothing of it is kept" % path, file=sys.stderr)
        return {}


def main():
    programs, source, folder = (os.path.abspath(word) for word in sys.argv[1:4])
    wanted, path = tuple(sys.argv[4:]), os.path.join(folder, "papers.json")
    machine, made = Machine(programs, source, folder), []
    kept = kept_tables(path) if wanted else {}
    tables = [pair for paper in PAPERS for pair in paper.tables(machine)]
    for word in wanted:
        if not any(table.name.startswith(word) for table, _ in tables):
            sys.exit("%s: no table has a name that begins so; they are %s" % (word, ", ".join(table.name for table, _ in tables)))
    try:
        for table, fill in tables:
            if wanted and not table.name.startswith(wanted):
                made.extend(kept[name] for name in kept if name == table.name)
                continue
            measure(table, fill)
            print("%-18s %5.1f s  %s. %s" % (table.name, table.seconds, table.holds(), table.remark), flush=True)
            for text, holds, found in table.claims:
                print("    %s: %s: %s" % ("holds" if holds else "does not hold", text, found), flush=True)
            made.append(table.json())
    finally:
        if machine.display:
            machine.display[0].terminate()
    papers = {"schema": SCHEMA, "machine": "%s, %d processors" % (processor(), os.cpu_count()), "tables": made}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(papers, file, indent=1, ensure_ascii=False)
    if not page.style(folder):
        machine.report_of("example-report", "scene:sphere:16")
    missing = page.missing_pictures(papers, folder)
    if missing:
        print("note: %d pictures of %s are not in %s, and the page says so; measured again, the tables draw them"
              % (len(missing), ", ".join(dict.fromkeys(name for name, _ in missing)), folder), file=sys.stderr)
    page.write_html(papers, folder)


main()
