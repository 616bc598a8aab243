#!/usr/bin/env python3
"""The page and the short form of what papers.py measured.

usage: page.py PAPERS.json PAPERS.md claims.md [--check]

Writes the tables and verdicts of PAPERS.json between the markers of PAPERS.md, and into claims.md whether each claim
that it links to holds. --check: only compares, and ends with 1 when a line differs."""
import base64
import html
import json
import os
import re
import sys

TITLES = {
    2003: "Bærentzen and Christensen, Hardware Accelerated Point Rendering of Isosurfaces",
    2004: "Guennebaud, Barthe and Paulin, Deferred Splatting",
    2006: "Zhang and Pajarola, Single-Pass Point Rendering and Transparent Shading",
    2008: "Marroquim, Kraus and Cavalcanti, Efficient Image Reconstruction for Point-Based and Line-Based Rendering",
    2010: "Aguirre, Gutierrez and Perrin, Rendering Large Point Datasets with GPU Shaders",
}
HOLDS = {"yes": "holds", "partly": "holds in part", "no": "does not hold", "not measured": "not measured"}
LOAD = ("The load is the mean number of busy processes in the minute before a table was measured, those of the tables before it "
        "among them.")
RULE = ("A claim is what a paper says, with a threshold that its own numbers give; it was written before anything was measured, and "
        "the numbers decide. Where a paper shows pictures only, 30 dB inside the outlines counts as hardly visible. Behind a "
        "PSNR stand, in brackets, the 99th percentile and the maximum of the pixels' errors, in steps of 255; behind a mean "
        "dilation those of the dilation.")
BEGIN, END = "<!-- BEGIN papers -->\n", "<!-- END papers -->\n"


def digits(value):
    """Three digits, or all of a count: 274,896, 22.9, 0.0144."""
    if value == "inf":
        return "∞"
    if isinstance(value, int):
        return "{:,}".format(value)
    return "%.3g" % value if abs(value) < 1000 else "{:,.0f}".format(float("%.3g" % value))


def number(cell):
    if cell is None:
        return "–"
    extremes = cell.get("extremes")
    return digits(cell["value"]) + (" (%s; %s)" % tuple(map(digits, extremes)) if extremes else "")


def measured(table):
    if table["load"] is None:
        return "(Measured on %s; the load was not recorded.)" % table["date"]
    return "(Measured on %s at a load of %.1f.)" % (table["date"], table["load"])


def holds_word(claim):
    return HOLDS["yes" if claim["holds"] else "no"]


# ---- the page

def style(folder):
    """The style of a report that isocompare made on the way, so that both look alike; "" without any."""
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name, "report.html")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                return re.search("<style>(.*?)</style>", file.read(), re.S).group(1)
    return ""


def missing_pictures(papers, folder):
    """Pairs of a table's name and a file: pictures of tables that were measured before and are no longer there."""
    return [(table["name"], picture["file"]) for table in papers["tables"] for picture in table["pictures"]
            if not os.path.exists(os.path.join(folder, picture["file"]))]


def html_picture(picture, folder):
    path = os.path.join(folder, picture["file"])
    if not os.path.exists(path):
        return "<p class=soft>%s is not here: it was drawn when the table was measured.</p>" % html.escape(picture["file"])
    with open(path, "rb") as file:
        data = base64.b64encode(file.read()).decode()
    return '<img alt="%s" src="data:image/png;base64,%s">' % (html.escape(picture["caption"]), data)


def html_table(table, folder):
    yield '<h3 id="%s">%s</h3>\n<p class=soft>%s</p>\n' % (table["name"], html.escape(table["title"]), html.escape(table["text"]))
    yield "<p><b>%s.</b> %s <span class=soft>%s</span></p>\n" % (HOLDS[table["holds"]].capitalize(),
                                                                html.escape(table["remark"]), measured(table))
    if table["claims"]:
        yield "<ul>%s</ul>\n" % "".join(
            "<li>%s: <b>%s</b>, %s</li>" % (html.escape(claim["claim"]), holds_word(claim), html.escape(claim["found"]))
            for claim in table["claims"])
    if table["rows"]:
        yield "<div class=wide><table><thead><tr><th></th>"
        yield "".join("<th>%s</th>" % html.escape(column) for column in table["columns"])
        yield "</tr></thead><tbody>\n"
        for row in table["rows"]:
            yield "<tr><td>%s</td>" % html.escape(row["what"])
            for cell in row["cells"]:
                command = html.escape(cell["command"]) if cell and "command" in cell else ""
                yield '<td title="%s">%s</td>' % (command, number(cell))
            yield "</tr>\n"
        yield "</tbody></table></div>\n"
    if table["pictures"]:
        yield '<div class=row style="--columns:%d">\n' % max(3, min(5, len(table["pictures"])))
        for picture in table["pictures"]:
            yield ("<figure class=shot>%s<figcaption>%s<br><span><code>%s</code></span></figcaption></figure>\n"
                   % (html_picture(picture, folder), html.escape(picture["caption"]), html.escape(picture["command"])))
        yield "</div>\n"


def write_html(papers, folder):
    with open(os.path.join(folder, "index.html"), "w", encoding="utf-8") as file:
        file.write("<!doctype html>\n<html lang=en><head><meta charset=utf-8>\n<title>What the papers claim, measured"
                   "</title>\n<style>%s\n.shot img{cursor:auto}.shot code{font-size:11px;overflow-wrap:anywhere}</style>"
                   "</head><body><main>\n" % style(folder))
        file.write("<h1>What the papers claim, measured</h1>\n<p class=soft>%s. %s %s The command behind each number shows "
                   "when the pointer rests on it; papers.json has them all.</p>\n" % (html.escape(papers["machine"]), RULE, LOAD))
        for year, title in TITLES.items():
            tables = [table for table in papers["tables"] if table["paper"] == year]
            if tables:
                file.write("<h2>%d: %s</h2>\n" % (year, html.escape(title)))
            for table in tables:
                file.writelines(html_table(table, folder))
        file.write("</main></body></html>\n")


# ---- the short form

def markdown(papers):
    yield "Measured on %s. %s %s\n" % (papers["machine"], RULE, LOAD)
    for year, title in TITLES.items():
        tables = [table for table in papers["tables"] if table["paper"] == year]
        if tables:
            yield "\n## %d: %s\n" % (year, title)
        for table in tables:
            yield '\n<a id="%s"></a>\n\n### %s\n\n' % (table["name"], table["title"])
            words = (table["text"], "**%s.**" % HOLDS[table["holds"]].capitalize(), table["remark"], measured(table))
            yield " ".join(word for word in words if word) + "\n"
            if table["claims"]:
                yield "\n"
            for claim in table["claims"]:
                yield "- %s: **%s**, %s\n" % (claim["claim"], holds_word(claim), claim["found"])
            if table["rows"]:
                yield "\n| | %s |\n|---%s|\n" % (" | ".join(table["columns"]), "|---:" * len(table["columns"]))
            for row in table["rows"]:
                yield "| %s | %s |\n" % (row["what"], " | ".join(number(cell) for cell in row["cells"]))
    yield "\n"


def short_form(papers, text):
    """docs/PAPERS.md with the tables between its markers."""
    head, rest = text.split(BEGIN)
    return head + BEGIN + "".join(markdown(papers)) + END + rest.split(END)[1]


def claims(papers, text):
    """docs/claims.md with the verdict's words in each link to a table; a link to a table that does not exist is an error."""
    holds = {table["name"]: HOLDS[table["holds"]] for table in papers["tables"]}

    def link(found):
        words, name = found.groups()
        return found.group(0) if words.split() == holds[name].split() else "[%s](PAPERS.md#%s)" % (holds[name], name)

    return re.sub(r"\[([^\]]*)\]\(PAPERS\.md#([^)]*)\)", link, text)


def renew(path, after, check):
    """Writes the file; or returns whether it has this text already, and prints the first line that differs."""
    with open(path, encoding="utf-8") as file:
        before = file.read()
    if check:
        for is_now, should in zip(before.splitlines(), after(before).splitlines()):
            if is_now != should:
                print("%s: is\n  %s\nbut should be\n  %s" % (path, is_now, should))
                break
        return after(before) == before
    with open(path, "w", encoding="utf-8") as file:
        file.write(after(before))
    return True


def main():
    words = [word for word in sys.argv[1:] if word != "--check"]
    with open(words[0], encoding="utf-8") as file:
        papers = json.load(file)
    same = [renew(path, lambda text, make=make: make(papers, text), "--check" in sys.argv)
            for path, make in zip(words[1:], (short_form, claims))]
    sys.exit(0 if all(same) else 1)


if __name__ == "__main__":
    main()
