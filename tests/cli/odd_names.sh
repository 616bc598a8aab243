python3 - <<'P'
import json, os, subprocess
from check import *
esc = b"a\x1b]0;title\x07\xff\xc2\x9bb\nc"
clean = "a\\x1b]0;title\\x07\\xff\\xc2\\x9bb\\nc"


def text(data):
    """The lines of what a program said, which must be printable UTF-8."""
    said = data.decode("utf-8")
    expect(all(c == "\n" or (c >= " " and not "\x7f" <= c <= "\x9f") for c in said), repr(said))
    return said.splitlines()


def run(*words, status=0):
    done = subprocess.run(words, capture_output=True)
    expect(done.returncode == status, words, done)
    return text(done.stdout), text(done.stderr)


ball("in/b.mha")
os.rename(b"in/b.mha", b"in/" + esc + b".mha")
name, path = b"in/" + esc + b".mha", "in/" + clean + ".mha"
# A file that is not there, one that is no volume, one that is too short.
for made in None, b"nothing\n", open(name, "rb").read()[:999]:
    bad = b"in/bad\n" + esc + b".mha"
    if made is not None:
        open(bad, "wb").write(made)
    out, said = run("isorender", bad, "out.png", status=3)
    expect(not out and len(said) == 1 and said[0].startswith("isorender: in/bad\\n" + clean + ".mha: "), said)
    os.path.exists(bad) and os.remove(bad)
# What is printed and written.
out, said = run("isorender", name, "--info")
expect(out[0] == path, out)
out, said = run("isorender", name, b"out" + esc + b".png", b"--json=" + esc + b".json", "--points", b"p.ply", "--mesh", "m.stl")
expect(any(line.endswith("wrote out" + clean + ".png") for line in said), said)
written = json.loads(open(esc + b".json", encoding="utf-8").read())
expect(written["volume"]["path"] == path, written["volume"])
expect(Png(b"out" + esc + b".png").texts["Title"] == clean, Png(b"out" + esc + b".png").texts)
for file, end in ("p.ply", b"end_header"), ("m.stl", b""):
    text(open(file, "rb").read(80 if not end else 4096).split(end)[0].strip(b"\0") if end else open(file, "rb").read(80).strip(b"\0"))
out, said = run("isocompare", "images", b"out" + esc + b".png", b"out" + esc + b".png")
expect("out" + clean + ".png" in out[0], out)
out, said = run("isocompare", "images", b"no" + esc, "x.png", status=3)
expect(len(said) == 1 and "no" + clean in said[0], said)
out, said = run("isosculpt", "--headless", "--replay", esc, status=3)
expect(len(said) == 1 and clean in said[0], said)
out, said = run("isorender", b"--" + esc, status=2)
expect(len(said) == 1 and clean in said[0], said)
P
