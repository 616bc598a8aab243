#!/usr/bin/env python3
"""Packages (debian/) are built with what ./run installs, the symbols of libisopoint0 are what the public headers declare, and the
Dockerfile says nothing twice: it runs ./run and installs packages of debian/control.

usage: packages.py ROOT [--write]     (--write adds the symbols of functions that are new in this version)
"""
import re
import sys
from pathlib import Path

SETS = ("build", "formats", "window", "pages", "gl")  # of ./run build
NOT_TO_BUILD = {"fonts-inter", "gcc", "g++"}  # (Debian builds packages with its compilers)


def fields(text, name):
    """The packages that fields of debian/control name, without versions and substitutions."""
    for value in re.findall(r"^%s:((?:.*\n)(?:^ .*\n)*)" % name, text, re.M):
        for one in re.split(r"[,|\n]", value):
            if one.strip() and "$" not in one.split("(")[0]:
                yield one.split("(")[0].strip()


def declared(root):
    for header in sorted((root / "src").glob("isopoint*.h")):
        text = re.sub(r"/\*.*?\*/", "", header.read_text(encoding="utf-8"), flags=re.S)
        yield from re.findall(r"^ISO_API [^;(]*?(\w+)\(", text, re.M)


def main():
    root = Path(sys.argv[1])
    bad = []
    run = (root / "run").read_text(encoding="utf-8")
    control = (root / "debian/control").read_text(encoding="utf-8")
    wanted = set()
    for name in SETS:
        wanted |= set(re.search(r'^packages_%s="([^"]*)"' % name, run, re.M)[1].split())
    wanted -= NOT_TO_BUILD
    listed = set(fields(control, "Build-Depends"))
    for package in sorted(wanted - listed):
        bad.append("debian/control: Build-Depends lacks %s, which ./run build installs" % package)
    installed = {word for words in re.findall(r'^packages_\w+="([^"]*)"', run, re.M) for word in words.split()}
    for package in sorted(listed | set(fields(control, "Build-Depends-Indep"))):
        if package not in installed and not package.startswith(("debhelper", "dh-sequence-")):
            bad.append("./run packages does not install %s of debian/control" % package)

    path = root / "debian/libisopoint0.symbols"
    version = ".".join(re.findall(r"#define ISO_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", (root / "src/isopoint.h").read_text()))
    symbols = dict(re.findall(r"^ (\w+)@Base (\S+)$", path.read_text(encoding="utf-8"), re.M))
    functions = set(declared(root))
    if "--write" in sys.argv[2:]:
        symbols = {name: symbols.get(name, version) for name in functions}
        path.write_text("libisopoint.so.0 libisopoint0 #MINVER#\n* Build-Depends-Package: libisopoint-dev\n" +
                        "".join(" %s@Base %s\n" % (name, symbols[name]) for name in sorted(symbols)), encoding="utf-8")
    if len(functions) < 50 or set(symbols) != functions:
        bad.append("%s is not what the headers declare (%s): run %s ROOT --write" % (
            path, " ".join(sorted(functions ^ set(symbols))), sys.argv[0]))

    docker = (root / "Dockerfile").read_text(encoding="utf-8")
    commands = set(re.findall(r"^  (\w+)", re.search(r"usage: ./run COMMAND\n\n(.*?)^END$", run, re.M | re.S)[1], re.M))
    for command in re.findall(r"\./run (\w+)", docker):
        if command not in commands:
            bad.append("Dockerfile: ./run %s is not there" % command)
    packages = set(re.findall(r"^Package: (\S+)$", control, re.M))
    for name in re.findall(r"/([a-z0-9-]+)_\*\.deb", docker):
        if name not in packages:
            bad.append("Dockerfile: debian/control has no package %s" % name)
    apt = set(re.findall(r"install -y --no-install-recommends ([a-z0-9 -]+)", docker)[0].split()) - {"git"}
    if "./run packages" not in docker or apt:
        bad.append("Dockerfile: what ./run packages installs is said in ./run: %s" % " ".join(sorted(apt)))
    if len(docker.splitlines()) > 20:
        bad.append("Dockerfile: more than 20 lines")
    if bad:
        sys.exit("\n".join(bad))
    print("%d packages to build with, %d symbols" % (len(listed), len(symbols)))


if __name__ == "__main__":
    main()
