# Processes of mpirun that were given other options, other files or other memory: refused by one line and one exit status on
# all of them, before anything is drawn; what a node decides for itself is agreed on.
which mpirun >/dev/null || { echo "skipped: no mpirun"; exit 77; }
[ -e "$(dirname "$(which isorender)")"/../lib*/isopoint/libisopoint-mpi.so ] || { echo "skipped: built without MPI"; exit 77; }
export OMPI_MCA_orte_tmpdir_base="$PWD/in" OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
python3 - <<'P'
import os
import re
import subprocess
from check import *


def ball(x, y, z):
    return max(0, 200 - int(((x - 40) ** 2 + (y - 40) ** 2 + (z - 40) ** 2) ** 0.5 * 4))


def nrrd(name, size, spacing=1, kind="uchar", pack="B", value=ball):
    with open(name, "wb") as file:
        file.write(b"NRRD0004\ntype: %s\ndimension: 3\nsizes: %d %d %d\nspacings: %g %g %g\nendian: little\nencoding: raw\n\n" %
                   (kind.encode(), *size, spacing, spacing, spacing))
        file.write(struct.pack("<%d%s" % (size[0] * size[1] * size[2], pack),
                               *(value(x, y, z) for z in range(size[2]) for y in range(size[1]) for x in range(size[0]))))


SIDE = (80, 80, 80)
nrrd("in/v.nrrd", SIDE)
nrrd("in/copy.nrrd", SIDE)
nrrd("in/longer.nrrd", (80, 80, 81))
nrrd("in/coarser.nrrd", SIDE, spacing=2)
nrrd("in/floats.nrrd", SIDE, kind="float", pack="f")
nrrd("in/other.nrrd", SIDE, value=lambda x, y, z: 200 - ball(x, y, z))
COMMON = ["--isovalue=90", "--resolution=160x120", "--threads=1", "--quiet"]


def together(rank, more=(), file="in/v.nrrd", common=COMMON, ranks=3, first=()):
    """Three ranks, of which one gets further options, or another file."""
    shell = 'n="$OMPI_COMM_WORLD_RANK"; rank="$1"; f="$2"; shift 2; if [ "$n" = "$rank" ]; then exec isorender "$f" "$@" %s; fi; ' \
            'exec isorender in/v.nrrd "$@" %s' % (" ".join(more), " ".join(first))
    return subprocess.run(["timeout", "60", "mpirun", "--oversubscribe", "-n", str(ranks), "sh", "-c", shell, "sh", str(rank), file,
                           *common, "-o", "together.png"], capture_output=True, text=True)


def check_refusal(status, words, done):
    lines = [line for line in done.stderr.splitlines() if line.startswith("isorender:")]
    expect(done.returncode == status and len(lines) == 1 and re.search(words, lines[0]), status, words, done.returncode, done.stderr)
    # Open MPI names one process of those that failed, and its exit status
    expect(not os.path.exists("together.png"), words)


def check_picture(done, right="alone.png"):
    expect(done.returncode == 0, done.stderr)
    expect(open(right, "rb").read() == open("together.png", "rb").read(), right)
    os.remove("together.png")


alone = subprocess.run(["isorender", "in/v.nrrd", *COMMON, "--fit", "box", "-o", "alone.png"], capture_output=True, text=True)
expect(alone.returncode == 0, alone.stderr)

# options
for rank, option in ((1, "--isovalue=91"), (0, "--isovalue=91"), (2, "--resolution=100x100"), (1, "--chunk-size=16"), (1, "--azimuth=1"),
                     (1, "--method=pullpush"), (1, "--crop=0,70,0,79,0,79"), (1, "--backend=cpu"),
                     (1, "--info")):
    check_refusal(2, "option %s: the processes of mpirun were given different values" % option.split("=")[0], together(rank, [option]))
check_refusal(2, "different numbers of inputs", together(1, ["in/copy.nrrd", "-o", "{model}.png"], first=["-o", "{model}.png"]))
check_refusal(2, "unknown option --no-such", together(1, ["--no-such"]))  # the others' options are right
check_refusal(2, "unknown option --no-such", together(0, ["--no-such"]))

# files
check_picture(together(1, file="in/copy.nrrd"))
check_refusal(3, "different volumes: their dimensions", together(1, file="in/longer.nrrd"))
check_refusal(3, "different volumes: their positions", together(2, file="in/coarser.nrrd"))
check_refusal(3, "different volumes: their kinds of voxels", together(1, file="in/floats.nrrd"))
check_refusal(3, "different volumes: their contents", together(0, file="in/other.nrrd"))
check_refusal(3, "in/missing.nrrd", together(1, file="in/missing.nrrd"))
check_refusal(6, "isovalue|surface", together(1, common=["--isovalue=1000", *COMMON[1:]]))

# what nodes decide for themselves: memory, from which the size of chunks follows; threads; what is said and kept
for more in (["--max-memory=3M"], ["--max-memory=1G"], ["--threads=2", "--verbose"], ["--no-index"], ["--json=a.json"]):
    check_picture(together(1, more))
P
