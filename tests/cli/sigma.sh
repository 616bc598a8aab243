# --isovalue 3sigma is the mean and three standard deviations of all finite voxels: of floats and integers, scaled or not,
# for any number of threads, from memory and in chunks, of the input and of further volumes, and again from a scene file.
python3 - <<'P'
import statistics
import struct
from check import *
N = 40
def value(x, y, z):
    return 900 - (x - 19) ** 2 - (y - 20) ** 2 - 2 * (z - 18) ** 2 if (x + y) % 7 else 400 + z
values = [value(x, y, z) for z in range(N) for y in range(N) for x in range(N)]
head = "NRRD0004\ntype: %s\ndimension: 3\nsizes: 40 40 40\nencoding: raw\nendian: little\n\n"
open("short.nrrd", "wb").write((head % "short").encode() + struct.pack("<%dh" % len(values), *values))
floats = [v / 1e6 for v in values]
floats[17], floats[1999] = float("nan"), float("inf")
open("float.nrrd", "wb").write((head % "float").encode() + struct.pack("<%df" % len(floats), *floats))
floats = [struct.unpack("<f", struct.pack("<f", f))[0] for f in floats if f == f and abs(f) != float("inf")]
open("expected", "w").write(repr([statistics.fmean(v) + s * statistics.pstdev(v) for v in (values, floats) for s in (1.5, -.5)]))
P
draw() { # NAME INPUT [OPTION..]
    isorender "$2" "$1.png" --resolution 60x60 --quiet --json="$1.json" "${@:3}"
}
for type in short float; do
    for threads in 1 2 5; do draw $type$threads $type.nrrd --isovalue 1.5sigma --threads $threads; done
    draw ${type}_low $type.nrrd --isovalue -0.5sigma
    draw ${type}_chunks $type.nrrd --isovalue 1.5sigma --chunk-size 16
    draw ${type}_scene $type.nrrd --isovalue 1.5sigma,-0.5sigma --save-scene $type.scene.json
    draw ${type}_again $type.scene.json
    draw ${type}_further short.nrrd --isovalue 700 --volume $type.nrrd --volume-isovalue 1.5sigma
done
python3 -c 'from check import *
expected = eval(open("expected").read())
for i, kind in enumerate(("short", "float")):
    high, low = expected[2 * i:2 * i + 2]
    near = lambda name, wanted: expect(all(abs(a - b) < 1e-8 * max(expected[2 * i:2 * i + 2]) for a, b in zip(report(name + ".json")["isovalues"], wanted)), name, report(name + ".json"), wanted)
    for name, wanted in (("1", [high]), ("_low", [low]), ("_chunks", [high]), ("_scene", [high, low]), ("_again", [high, low])):
        near(kind + name, wanted)
    expect(abs(report(kind + "_further.json")["volumes"][0]["isovalue"] - high) < 1e-8 * abs(high), kind)
    hashes = {report(kind + name + ".json")["isovalues"][0] for name in ("1", "2", "5", "_chunks", "_scene", "_again")}
    expect(len(hashes) == 1, kind, hashes)'
isorender short.nrrd x.png --isovalue 1.5sigma 2>&1 | grep -q 'isovalue .* (1.5 sigma: mean .*, standard deviation'
isorender_refuses 2 "'3sigmas' is neither a number, such as 40 or 3sigma, nor 'auto'" short.nrrd --isovalue 3sigmas
isorender_refuses 2 'isovalue 3sigma is given twice' short.nrrd --isovalue 3sigma,40,3sigma
