# How Sphinx makes a site of these pages: ./run docs
import re
from pathlib import Path

project = "Isopoint"
extensions = ["myst_parser"]
html_theme = "furo"
html_title = "Isopoint"
myst_heading_anchors = 3  # links to headings, as on the pages of a repository
suppress_warnings = ["myst.header"]  # pages may begin with any level


PICTURES = Path(__file__).parent.parent / "build" / "gallery"  # tests/gallery/gallery.py


def with_picture(match):
    """Puts the picture that commands make below them, if it has been made."""
    commands, name = match.groups()
    return commands + ("\n![%s](../build/gallery/%s)\n" % (name, name) if (PICTURES / name).exists() else "")


def as_site(app, page, source):
    """The README becomes the first page, and places that HTML names in pages become targets of Sphinx."""
    text = source[0]
    if page == "index":
        readme = Path(app.srcdir, "..", "README.md").read_text(encoding="utf-8")
        readme = re.sub(r"\[([^]]*)\]\(volumes/[^)]*\)", r"\1", readme)
        text = readme.replace("](docs/", "](").replace("](src/", "](../src/") + text
    if page in ("gallery", "gallery-figures"):
        text = re.sub(r"((?:^    \S.*\n)*^    .*?\b(\w+\.png)\b.*\n)", with_picture, text, flags=re.M)
    text = text.replace("](../README.md#", "](index.md#")
    text = re.sub(r'<a id="([^"]*)"></a>\n', r"(\1)=", text)
    source[0] = re.sub(r"\]\(PAPERS\.md#([0-9][^)]*)\)", r"](\1)", text)


def setup(app):
    app.connect("source-read", as_site)
    return {"parallel_read_safe": True}
