# NRRD headers that lie or are endless: status 3 and one line that names the file, soon and in little memory.
python3 - <<'END'
import os, resource, subprocess, sys, time

SIZES = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 16 16\n"
HEAD = SIZES + "encoding: raw\n"
VOXELS = "\1" * 4096
FILES = {
    "field.nrrd": HEAD + "y" * 1000 + "\n\n" + VOXELS,
    "unknown.nrrd": HEAD + "foo: " + "y" * 1000 + "\n\n" + VOXELS,
    "type.nrrd": "NRRD0004\ntype: " + "u" * 1000 + "\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n" + VOXELS,
    "encoding.nrrd": SIZES + "encoding: " + "u" * 1000 + "\n\n" + VOXELS,
    "kinds.nrrd": HEAD + "kinds: " + "u" * 1000 + "\n\n" + VOXELS,
    "token.nrrd": SIZES + "encoding: ascii\n\n" + "z" * 1000,
    "number.nrrd": SIZES + "encoding: ascii\n\n" + "1" * 1000,
    "pairs.nrrd": HEAD + "".join("k%d:=x\n" % i for i in range(40000)) + "\n" + VOXELS,
    "endless.nrrd": HEAD + "#" * 5000000,
    "lines.nrrd": "NRRD0004\n" + "#\n" * 2000000,
    "width.nhdr": HEAD + "data file: x%100d.raw 1 16 1\n",
    "wide.nhdr": HEAD + "data file: x%100000d.raw 1 16 1\n",
    "many.nhdr": HEAD + "data file: x%d.raw 1 2147483647 1\n",
    "slabs.nhdr": HEAD + "data file: x%d.raw 1 2147483647 1 3\n",
    "string.nhdr": HEAD + "data file: x%d%s%n%n%n.raw 1 16 1\n",
    "name.nhdr": HEAD + "data file: " + "x" * 1000 + "\n",
    "names.nhdr": HEAD + "data file: " + "./" * 2048 + "x\n",
    "list.nhdr": HEAD + "data file: LIST\n" + "x\n" * 1000000,
    "self.nhdr": HEAD + "byte skip: 9223372036854775807\ndata file: self.nhdr\n",
    "skip.nhdr": HEAD + "line skip: 18446744073709551615\ndata file: skip.nhdr\n",
    "sizes.nrrd": "NRRD0004\ntype: double\nendian: big\ndimension: 16\nsizes:" + " 4294967295" * 16 + "\nencoding: raw\n\n",
    "vectors.nrrd": HEAD + "space dimension: 8\nspace directions: " + "(1,0,0,0,0,0,0,0) " * 5000 + "\n\n" + VOXELS,
    "quotes.nrrd": HEAD + 'units: "' + '\\"' * 50000 + "\n\n" + VOXELS,
}
LIMIT = 64 << 20  # for reading; the program itself takes less than as much again
for name, text in FILES.items():
    with open("in/" + name, "w") as file:
        file.write(text)
    begin = time.monotonic()
    run = subprocess.run(["isorender", "in/" + name, "out.png", "--max-memory", str(LIMIT)], capture_output=True, timeout=60)
    seconds = time.monotonic() - begin
    line = run.stderr.decode()
    good = run.returncode == 3 and line.count("\n") == 1 and line.startswith("isorender: in/" + name + ": ")
    if not good or seconds > 10 or len(line) > 600 or os.path.exists("out.png"):
        sys.exit("%s: status %d after %.1f s: %s" % (name, run.returncode, seconds, line))
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
if peak > 2 * LIMIT:
    sys.exit("%.0f MB in memory" % (peak / 1e6))
END
