#!/usr/bin/env python3
"""Bindings to other languages can be made of the public header: cffi parses it, and the C that it generates of every
struct and function compiles.

usage: bindings.py ROOT CC FOLDER
"""
import subprocess
import sys
import sysconfig
from pathlib import Path


def main():
    root, compiler, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    try:
        import cffi  # noqa: F401
    except ImportError:
        sys.exit(77)
    sys.path.insert(0, str(root / "python/isopoint"))
    sys.dont_write_bytecode = True
    import _build
    python = sysconfig.get_paths()["include"]
    if not (Path(python) / "Python.h").exists():
        sys.exit(77)
    source = folder / "bindings.c"
    _build.make(str(root / "src")).emit_c_code(str(source))
    subprocess.run([compiler, "-std=c17", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter",
                    "-Wno-missing-field-initializers", f"-I{root / 'src'}", f"-isystem{python}", str(source)], check=True)
    print(source.read_text().count("iso_"), "names bound")


main()
