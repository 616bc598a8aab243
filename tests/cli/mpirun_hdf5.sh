# HDF5 arrays by h5py that libhdf5 decodes (szip, nbit, scaleoffset, integers of 3 bytes) or converts nothing of (floats of 16 bits) give
# the picture of the .nrrd with the same voxels: whole, in chunks, with little memory, in parts, and by several processes.
for python in python3 /usr/bin/python3 none; do $python -c 'import h5py' 2>/dev/null && break; done
[ $python != none ] || { echo "skipped: no h5py"; exit 77; }
[ -e "$(dirname "$(which isorender)")"/../lib*/isopoint/libisopoint-hdf5.so ] || { echo "skipped: built without HDF5"; exit 77; }
export OMPI_MCA_orte_tmpdir_base="$PWD/in" OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
$python - <<'P'
import glob
import os
import shutil
import subprocess
import h5py
import numpy
from h5py import h5d, h5p, h5s, h5t, h5z
from check import *

z, y, x = numpy.mgrid[0:150, 0:131, 0:140]
waves = 1000 + 600 * numpy.sin(x / 9) * numpy.cos(y / 7) + 390 * numpy.sin(z / 8 + x / 19)
chunk = (32, 48, 40)


def write(name, array, type=None, **how):
    with h5py.File("in/a.h5", "w") as file:
        if type is None:
            file.create_dataset("a", data=array, chunks=chunk, **how)
            return
        creation = h5p.create(h5p.DATASET_CREATE)
        creation.set_chunk(chunk)
        creation.set_filter(h5z.FILTER_NBIT)
        h5d.create(file.id, b"a", type, h5s.create_simple(array.shape), creation).write(h5s.ALL, h5s.ALL, array)


def integer(like, size, bits, offset):
    made = like.copy()
    made.set_size(size)
    made.set_precision(bits)
    made.set_offset(offset)
    return made


def run(*arguments, ranks=0):
    start = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    done = subprocess.run([*start, "isorender", *arguments, "--isovalue", "1100", "--resolution", "160x120", "--fit", "box", "--threads", "2"],
                          capture_output=True, text=True)
    expect(done.returncode == 0, arguments, done.stderr)
    return done.stderr


def same(what):
    expect(Png("whole.png").rows == Png("a.png").rows, what)  # (the files also hold their scenes, which differ)
    os.remove("a.png")


cases = [("szip", "uint16", "<u2", dict(compression="szip")), ("scaleoffset", "int16", "<i2", dict(scaleoffset=0, compression="gzip")),
         ("nbit", "uint16", "<u2", dict(type=integer(h5t.STD_U16BE, 2, 12, 3))),
         ("integers of 24 bits in 3 bytes", "float", "<u4", dict(type=integer(h5t.STD_U32LE, 3, 24, 0))),
         (None, "float", ">f2", dict(compression="gzip", shuffle=True)), ("szip", "float", "<f2", dict(compression="szip"))]
mpi = shutil.which("mpirun") and glob.glob(os.path.dirname(shutil.which("isorender")) + "/../lib*/isopoint/libisopoint-mpi.so")
for number, (said, nrrd, kind, how) in enumerate(cases):
    if how.get("compression") == "szip" and "szip" not in h5py.filters.encode:
        print("SKIP: h5py cannot encode szip")
        continue
    array = waves.astype(kind)
    write("a", array, **how)
    with open("in/a.nrrd", "wb") as file:
        file.write(b"NRRD0004\ntype: %s\ndimension: 3\nsizes: 140 131 150\nendian: little\nencoding: raw\n\n" % nrrd.encode())
        file.write(array.astype({"float": "<f4"}.get(nrrd, kind)).tobytes())
    run("in/a.nrrd", "-o", "whole.png")
    notes = run("in/a.h5", "-o", "a.png")
    same((said, "whole"))
    expect(("libhdf5 decodes it, one chunk at a time" in notes) == bool(said) and (said or "") in notes, said, notes)
    info = subprocess.run(["isorender", "--info", "in/a.h5"], capture_output=True, text=True)
    expect((said or "half") in info.stderr + info.stdout, info)
    # A sanitizer keeps the memory that was freed, which the process that decodes must pay for.
    little = "64M" if "ASAN_OPTIONS" in os.environ else "7M"
    for limit in (["--chunk-size", "48"], ["--max-memory", little, "--chunk-size", "32"]):
        run("in/a.h5", "-o", "a.png", *limit)
        same((said, limit))
        for index in glob.glob("in/*.isoindex"):
            os.remove(index)
    if number % 2:
        parts = ["%d.isokeys" % part for part in (3, 1, 2)]
        for part in parts:
            run("in/a.h5", "--part", part[0] + "/3", "-o", part)
        subprocess.run(["isorender", "merge", *parts, "-o", "a.png", "--quiet"], check=True)
        same((said, "parts"))
    elif mpi:
        run("in/a.h5", "-o", "a.png", ranks=3)
        same((said, "mpirun"))
P
