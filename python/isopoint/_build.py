"""Makes the extension isopoint._native of the public header, the only description of the library that there is."""
import os
import re
import shlex
from pathlib import Path

import cffi  # type: ignore[import]

HEADERS = os.environ.get("ISOPOINT_INCLUDE") or str(Path(__file__).resolve().parents[2] / "src")
CALLBACKS = 'extern "Python" int isopoint_progress(void *context, double fraction);'


def declarations(folder: str) -> str:
    """The header and the chapters that it includes at its end, without what cffi's parser does not know: comments, the
    preprocessor's lines, ISO_API, and extern "C" { }."""
    text = (Path(folder) / "isopoint.h").read_text()
    text += "".join((Path(folder) / name).read_text() for name in re.findall(r'#include "(\w+\.h)"', text))
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    text = re.sub(r'#ifdef __cplusplus\n(extern "C" \{|\})\n#endif\n', "", text)
    return re.sub(r"(?m)^#.*$", "", text).replace("ISO_API ", "")


def make(folder: str) -> cffi.FFI:
    ffi = cffi.FFI()
    ffi.cdef(declarations(folder))
    ffi.cdef(CALLBACKS)
    ffi.set_source("isopoint._native", '#include "isopoint.h"', include_dirs=[folder], libraries=["m", "pthread"],
                   extra_compile_args=["-O2", "-g0"],
                   extra_link_args=["-Wl,--exclude-libs,ALL", "-Wl,--gc-sections", "-Wl,-s", "-Wl,--as-needed",
                                    *shlex.split(os.environ.get("ISOPOINT_LIBS", "-lpng -lz -ljansson"))])
    return ffi


ffi = make(HEADERS)
