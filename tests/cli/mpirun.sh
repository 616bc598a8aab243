# Pictures by several processes of mpirun are the bytes of those by one; a failure is said once, with its exit status.
which mpirun >/dev/null || { echo "skipped: no mpirun"; exit 77; }
[ -e "$(dirname "$(which isorender)")"/../lib*/isopoint/libisopoint-mpi.so ] || { echo "skipped: built without MPI"; exit 77; }
export OMPI_MCA_orte_tmpdir_base="$PWD/in" OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
python3 - <<'P'
import os
import subprocess
from check import *
import math

volume("in/waves.mha", (90, 70, 83), lambda x, y, z: 100 * math.sin(x / 5) * math.cos(y / 4) + 50 * math.sin(z / 3 + x / 9),
       header="ElementSpacing = 0.7 1.9 1.2\nOffset = -5 3 11\n")


def run(ranks, *arguments, shell=None):
    program = ["sh", "-c", shell, "sh"] if shell else ["isorender"]
    start = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    return subprocess.run([*start, *program, *arguments, "--threads", "1"], capture_output=True, text=True)


pictures = [["in/waves.mha", "--isovalue", "20", "--camera", "iso"],
            ["in/waves.mha", "--isovalue", "20", "--chunk-size", "32", "--orthographic", "--azimuth", "30", "--fit", "tight", "--scale-bar"],
            ["scene:ct:80", "--chunk-size", "16", "--camera-position", "20,60,40", "--camera-focal-point", "60,10,30", "--view-angle", "90"],
            ["in/waves.mha", "--isovalue", "-9", "--chunk-size", "32", "--method", "pullpush", "--reconstruction", "gaussian"],
            ["scene:ct:80", "--chunk-size", "32", "--method", "pullpush", "--reconstruction", "box"]]
for number, picture in enumerate(pictures):
    alone = run(0, *[a for a in picture if a not in ("--chunk-size", "16", "32")], "-o", "alone.png", "--resolution", "160x120", "--quiet")
    expect(alone.returncode == 0, alone.stderr)
    for ranks in ((1, 2, 3, 4, 7) if number == 1 else (2 + number % 3,)):
        done = run(ranks, *picture, "-o", "together.png", "--resolution", "160x120", "--json=a.json")
        expect(done.returncode == 0, done.stderr)
        expect(open("alone.png", "rb").read() == open("together.png", "rb").read(), picture, ranks)
        expect(done.stderr.count("wrote together.png") == 1, done.stderr)
        said = report("a.json")
        expect(ranks == 1 or said["ranks"] == ranks and len(said["peak_bytes_of_ranks"]) == 3, said)
        os.remove("together.png")


def check_failure(status, words, done):
    lines = [line for line in done.stderr.splitlines() if line.startswith("isorender:")]
    expect(done.returncode == status and len(lines) == 1 and words in lines[0], status, words, done.returncode, done.stderr)
    expect(not os.path.exists("together.png"))


check_failure(2, "unknown option", run(3, "in/waves.mha", "-o", "together.png", "--no-such-option"))
check_failure(2, "cannot be drawn in chunks", run(3, "in/waves.mha", "-o", "together.png", "--samples", "4"))
check_failure(3, "missing.mha", run(3, "in/missing.mha", "-o", "together.png"))
check_failure(6, "no surface", run(2, "in/waves.mha", "-o", "together.png", "--isovalue", "1e6"))
check_failure(7, "nowhere", run(2, "in/waves.mha", "-o", "nowhere/together.png", "--isovalue", "20"))
with open("in/short.mha", "wb") as file:
    file.write(open("in/waves.mha", "rb").read()[:-5])
# on one rank only
check_failure(3, "truncated", run(3, "-o", "together.png", "--isovalue", "20",
                                  shell='f=in/waves.mha; [ "$OMPI_COMM_WORLD_RANK" = 1 ] && f=in/short.mha; exec isorender "$f" "$@"'))
done = run(3, "in/waves.mha", "-o", "together.png", "--isovalue", "20",
           shell='[ "$OMPI_COMM_WORLD_RANK" = 1 ] && kill -9 $$; exec isorender "$@"')
expect(done.returncode != 0 and not os.path.exists("together.png"), done.returncode)
P
