"""Builds the Python package: pip install .

The C library is built by its own CMake, alone and without the formats that Python's own libraries read, unless
ISOPOINT_LIBRARY names a libisopoint.a or libisopoint.so that is there already. ISOPOINT_CMAKE: further options of
CMake; ISOPOINT_LIBS: what is linked besides (-lpng -lz -ljansson, or paths of static libraries)."""
import os
import re
import shlex
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
OFF = "VTK OPENVDB TIFF HDF5 ZARR GDCM BZIP2 NIFTI OPENEXR JPEG GL".split()


def version() -> str:
    text = (ROOT / "src/isopoint.h").read_text()
    return ".".join(re.findall(r"#define ISO_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


class BuildExtension(build_ext):
    def run(self) -> None:
        library = os.environ.get("ISOPOINT_LIBRARY")
        if not library:
            tree = Path(self.build_temp).resolve() / "isopoint"
            subprocess.check_call(
                ["cmake", "-S", str(ROOT), "-B", str(tree), "-DCMAKE_BUILD_TYPE=Release", "-DISO_PROGRAMS=OFF", "-DISO_UNITY=ON",
                 *[f"-DISO_WITH_{name}=OFF" for name in OFF], *shlex.split(os.environ.get("ISOPOINT_CMAKE", ""))])
            subprocess.check_call(["cmake", "--build", str(tree), "--target", "isopoint",
                                   "--parallel", str(os.cpu_count() or 1)])
            library = str(next(tree.rglob("libisopoint.a")))
        for extension in self.extensions:
            extension.extra_objects = [library]
            extension.depends = [library]
        super().run()


setup(version=version(), cffi_modules=["python/isopoint/_build.py:ffi"], cmdclass={"build_ext": BuildExtension},
      options={"bdist_wheel": {"py_limited_api": "cp39"}}, zip_safe=False)
