# Only the main input of isorender may be a FIFO. Wherever else a file is looked for, one that nobody writes to is refused or
# passed over at once: as further inputs, beside the input, in folders.
python3 - <<'P'
import os
import shutil
import subprocess
from check import *

os.chdir("in")
ball("ball.mha", 16, 5)


def ends(status, what, program, *arguments):
    try:
        done = subprocess.run([program, *arguments, "--quiet"], capture_output=True, text=True, timeout=20)
    except subprocess.TimeoutExpired:
        raise SystemExit("%s: waits for the FIFO: %s" % (program, arguments))
    lines = done.stderr.count("\n")
    expect(done.returncode in status and lines == (done.returncode != 0), (arguments, done.returncode, done.stderr))
    expect(done.returncode == 0 or what in done.stderr, (arguments, done.stderr))


def refused(what, *arguments):
    ends((3,), what + ": not a ", "isorender", *arguments, "-o", "o.png", "--resolution", "16x16")
    expect(not os.path.exists("o.png"), arguments)


# ---- further inputs
for option in ("--volume", "--surface", "--lines", "--glyphs"):
    for name in ("p.ply", "p.vtk", "p.vtp", "p.obj", "p.stl", "p.swc", "p.tck", "p.trk", "p.csv", "p.xyz", "p.pdb", "p.nrrd", "p.mha", "p.nii",
                 "p.tif", "p.vdb", "p.vti", "p.h5", "p.dcm", "p.las", "p.raw", "p"):
        os.mkfifo(name)
        ends((2, 3), name, "isorender", "ball.mha", option, name, "-o", "o.png")
        os.remove(name)
for name in ("p.nrrd", "p.ply", "p"):
    os.mkfifo(name)
    refused(name, "ball.mha", "--panel-file", name)
    ends((2,), "--panels reads " + name, "isorender", name, "--panels", "isovalue=1,2", "-o", "o.png")
    os.remove(name)
ends((2,), "--panels reads standard input", "isorender", "-", "--panels", "isovalue=1,2", "-o", "o.png")
os.makedirs("bids/sub-1/anat")
with open("bids/dataset_description.json", "w") as file:
    file.write("{}")
os.mkfifo("bids/sub-1/anat/sub-1_T1w.nii")
ends((3,), "sub-1_T1w.nii: not a regular file", "isorender", "sheet", "bids", "-o", "o.html")
shutil.rmtree("bids")
os.mkfifo("p.png")
os.mkfifo("p.exr")
for name in ("p.png", "p.exr"):
    refused(name, "ball.mha", "--ior", "1.5", "--environment", name)
os.remove("p.png")
os.remove("p.exr")
os.mkfifo("p.isokeys")
ends((3,), "p.isokeys", "isorender", "merge", "p.isokeys", "-o", "o.png")
for name in ("p.strokes", "p.ply", "p.csv", "p.swc", "p.vdb"):
    os.mkfifo(name)
    ends((2, 3), name, "isosculpt", "--open", name, "--headless", "-o", "o.stl")
    ends((2, 3), name, "isosculpt", "--open", "ball.mha", "--isovalue", "1", "--reference", name, "--headless", "-o", "o.stl", "--draw")
    os.remove(name)

# ---- parts of a volume in several files
with open("a.mhd", "w") as file:
    file.write("NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = part\n")
with open("a.nhdr", "w") as file:
    file.write("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: part\n")
os.mkfifo("part")
refused("part", "a.mhd")
refused("part", "a.nhdr")
os.remove("part")
with open("n.hdr", "wb") as file:
    header = bytearray(348)
    header[0:4] = (348).to_bytes(4, "little")
    header[40:56] = b"".join(n.to_bytes(2, "little") for n in (3, 2, 2, 2, 1, 1, 1, 1))
    header[70:74] = b"\x02\0\x08\0"
    for at in range(76, 92, 4):
        header[at:at + 4] = b"\0\0\x80\x3f"
    header[344:348] = b"ni1\0"
    file.write(header)
os.mkfifo("n.img")
refused("n.img", "n.hdr")
os.remove("n.img")

# ---- folders: every name that a reader may look for
def zarr(folder):
    os.makedirs(folder + "/0")
    with open(folder + "/0/.zarray", "w") as file:
        file.write('{"zarr_format":2,"shape":[3,3,3],"chunks":[3,3,3],"dtype":"|u1","order":"C","fill_value":0,"filters":null,"compressor":null}')
    with open(folder + "/.zattrs", "w") as file:
        file.write('{"multiscales":[{"version":"0.4","axes":[{"name":"z","type":"space"},{"name":"y","type":"space"},{"name":"x","type":"space"}],'
                   '"datasets":[{"path":"0"}]}]}')
    with open(folder + "/0/0.0.0", "wb") as file:
        file.write(bytes(200 if i == 13 else 0 for i in range(27)))


for name in (".zattrs", ".zgroup", "zarr.json", ".zarray", ".zmetadata", "attributes.json", "0/.zarray", "0/.zattrs", "0/zarr.json",
             "0/attributes.json", "0/0.0.0"):
    zarr("z.zarr")
    if os.path.exists("z.zarr/" + name):
        os.remove("z.zarr/" + name)
    os.mkfifo("z.zarr/" + name)
    ends((0, 3), "z.zarr", "isorender", "z.zarr", "-o", "o.png", "--resolution", "16x16", "--isovalue", "100")
    if os.path.exists("o.png"):
        os.remove("o.png")
    shutil.rmtree("z.zarr")
for name in ("1.dcm", "1", "DICOMDIR", "1.tif", "zarr.json", ".zarray", "attributes.json"):
    os.mkdir("folder")
    os.mkfifo("folder/" + name)
    ends((3,), "folder", "isorender", "folder", "-o", "o.png")
    shutil.rmtree("folder")
P
