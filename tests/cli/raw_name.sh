# The layout of a raw file is taken from its name when its size agrees, and that is said; --raw comes first.
python3 - <<'END'
import json, struct, subprocess, sys

DIMS = (7, 6, 5)
VALUES = [x * 100 + y * 10 + z for z in range(5) for y in range(6) for x in range(7)]


def run(name, code, *options, scale=1):
    with open("in/" + name, "wb") as file:
        file.write(struct.pack(code[:-1] + "%d" % len(VALUES) + code[-1], *(v // scale for v in VALUES)))
    done = subprocess.run(["isorender", "in/" + name, "--info", "--json=o.json", *options], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit("%s: %s" % (name, done.stderr))
    report = json.load(open("o.json"))
    return done, {**report["volume"], "range": report["value_range"]}


for name, code, kind, order in (("tooth_7x6x5_uint16.raw", "<H", "uint16", "little"), ("a_7x6x5_int16_be.raw", ">h", "int16", "big"),
                                ("a-7X6X5-short-little", "<h", "int16", "little"), ("a_7x6x5_ushort_big.bin", ">H", "uint16", "big"),
                                ("float_7x6x5_float32.raw", "<f", "float32", "little"), ("x_float_7x6x5_le.dat", "<f", "float32", "little"),
                                ("7x6x5.FLOAT.raw", "<f", "float32", "little")):
    done, volume = run(name, code)
    note = "layout taken from the file's name: 7x6x5:%s:%s (--raw)" % (kind, order)
    if volume["dims"] != [7, 6, 5] or volume["type"] != kind or volume["range"][1] != 654 or note not in volume["notes"]:
        sys.exit("%s: %s" % (name, volume))
    if note not in done.stdout + done.stderr:
        sys.exit("%s: nothing about the name in %s %s" % (name, done.stdout, done.stderr))
done, volume = run("b_7x6x5_uint8.raw", "<B", scale=3)
if volume["type"] != "uint8" or volume["range"][1] != 218:
    sys.exit("uint8: %s" % volume)
done, volume = run("c_7x6x5_int16.raw", "<h", "--raw", "5x6x7:uint16")
if volume["dims"] != [5, 6, 7] or "name" in " ".join(volume.get("notes", [])):
    sys.exit("--raw: %s" % volume)

with open("in/d_7x6x5_int16.raw", "wb") as file:
    file.write(bytes(419))
done = subprocess.run(["isorender", "in/d_7x6x5_int16.raw"], capture_output=True, text=True)
wanted = "isorender: in/d_7x6x5_int16.raw: has 419 bytes, but 7x6x5 int16, as its name says, are 420: give its layout (--raw)\n"
if done.returncode != 3 or done.stderr != wanted:
    sys.exit("sizes: status %d, %s" % (done.returncode, done.stderr))
for name in ("e_7x6x5.raw", "e_7x6x5_1x1x1_uint8.raw", "e_7x6_uint8.raw", "e_7x6x5_quad.raw", "e_0x6x5_uint8.raw"):
    with open("in/" + name, "wb") as file:
        file.write(bytes(210))
    done = subprocess.run(["isorender", "in/" + name], capture_output=True, text=True)
    if done.returncode != 3 or "raw data needs a layout (--raw WxHxD:TYPE)" not in done.stderr:
        sys.exit("%s: status %d, %s" % (name, done.returncode, done.stderr))
END
isosculpt --open in/b_7x6x5_uint8.raw --isovalue 100 --headless --output out.stl 2>said
grep -q "^isosculpt: in/b_7x6x5_uint8.raw: note: layout taken from the file's name: 7x6x5:uint8:little" said || { cat said; exit 1; }
isosculpt -q --open in/b_7x6x5_uint8.raw --isovalue 100 --headless --output out.stl 2>said
[ ! -s said ] || { cat said; exit 1; }
