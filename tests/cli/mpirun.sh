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


pictures = [["in/waves.mha", "--isovalue", "20", "--camera", "iso", "--fit", "box"],
            ["in/waves.mha", "--isovalue", "20", "--chunk-size", "32", "--orthographic", "--azimuth", "30", "--fit", "tight", "--scale-bar"],
            ["scene:ct:80", "--chunk-size", "16", "--camera-position", "20,60,40", "--camera-focal-point", "60,10,30", "--view-angle", "90"],
            ["scene:ct:80", "--chunk-size", "16", "--clip", "y<35", "--clip", "40,40,40:1,2,-3", "--cap", "slice", "--fit", "box"],
            ["in/waves.mha", "--isovalue", "-9", "--chunk-size", "32", "--method", "pullpush", "--reconstruction", "gaussian",
             "--fit", "box"],
            ["scene:ct:80", "--chunk-size", "32", "--method", "pullpush", "--reconstruction", "box", "--fit", "box"]]
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

# without an isovalue the values are counted together: of floats with padding and voxels that are no numbers, and of integers
volume("in/padded.mha", (60, 50, 33), lambda x, y, z: -1000 if x < 9 or y < 9 or z > 25 or x > 50 or y > 41 or z < 4 else
       math.nan if x == y == z else 100 * math.sin(x / 5) * math.cos(y / 4) + z)
with open("in/counted_40x50x41_int16.raw", "wb") as file:
    file.write(struct.pack("<%dh" % (40 * 50 * 41), *[(x * y + 7 * z) % 1200 - 300 for z in range(41) for y in range(50) for x in range(40)]))
for name in ("in/padded.mha", "in/counted_40x50x41_int16.raw"):
    alone = run(0, name, "-o", "alone.png", "--resolution", "160x120", "--fit", "box", "--json=alone.json", "--quiet")
    expect(alone.returncode == 0, alone.stderr)
    for ranks in (2, 3, 7):
        done = run(ranks, name, "-o", "together.png", "--resolution", "160x120", "--fit", "box", "--json=a.json", "--no-index")
        expect(done.returncode == 0, name, ranks, done.stderr)
        expect(open("alone.png", "rb").read() == open("together.png", "rb").read(), name, ranks)
        for key in ("histogram", "isovalues", "isovalue"):
            expect(report("a.json").get(key) == report("alone.json").get(key), key, name, ranks)
        os.remove("together.png")

# ranks without any crossed brick
volume("in/dot.mha", (64, 64, 64), lambda x, y, z: 9 if 20 <= x < 25 and 40 <= y < 44 and 50 <= z < 55 else 0)
for method in ([], ["--method", "pullpush", "--reconstruction", "box"]):
    dot = ["in/dot.mha", "--isovalue", "4", "--resolution", "160x120", "--fit", "box", *method, "-o"]
    alone, done = run(0, *dot, "alone.png"), run(5, *dot, "together.png", "--chunk-size", "16")
    expect(alone.returncode == 0 and done.returncode == 0, method, alone.stderr, done.stderr)
    expect(open("alone.png", "rb").read() == open("together.png", "rb").read(), method)
    os.remove("together.png")


def check_failure(status, words, done):
    lines = [line for line in done.stderr.splitlines() if line.startswith("isorender:")]
    expect(done.returncode == status and len(lines) == 1 and words in lines[0], status, words, done.returncode, done.stderr)
    expect(not os.path.exists("together.png"))


check_failure(2, "unknown option", run(3, "in/waves.mha", "-o", "together.png", "--no-such-option"))
check_failure(2, "cannot be drawn in chunks", run(3, "in/waves.mha", "-o", "together.png", "--aov", "a.exr"))
check_failure(3, "missing.mha", run(3, "in/missing.mha", "-o", "together.png"))
check_failure(6, "no surface", run(2, "in/waves.mha", "-o", "together.png", "--isovalue", "1e6"))
check_failure(7, "nowhere", run(2, "in/waves.mha", "-o", "nowhere/together.png", "--isovalue", "20"))
os.symlink("/dev/full", "full.png")  # a full disk, where only rank 0 writes
check_failure(7, "full.png", run(3, "in/waves.mha", "-o", "full.png", "--isovalue", "20"))
with open("in/short.mha", "wb") as file:
    file.write(open("in/waves.mha", "rb").read()[:-5])
# on one rank only
check_failure(3, "truncated", run(3, "-o", "together.png", "--isovalue", "20",
                                  shell='f=in/waves.mha; [ "$OMPI_COMM_WORLD_RANK" = 1 ] && f=in/short.mha; exec isorender "$f" "$@"'))
done = run(3, "in/waves.mha", "-o", "together.png", "--isovalue", "20",
           shell='[ "$OMPI_COMM_WORLD_RANK" = 1 ] && kill -9 $$; exec isorender "$@"')
expect(done.returncode != 0 and not os.path.exists("together.png"), done.returncode)
P
