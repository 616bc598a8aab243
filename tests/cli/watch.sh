# --watch draws again when the input changes, also a sheet, each time to the bytes of a fresh run; an interrupt ends it.
python3 - <<'P'
import os, signal, subprocess, time
from check import *
def until(what):
    for _ in range(600):
        if what():
            return
        time.sleep(0.05)
    expect(False, "not in 30 s")
def replace_input(radius):
    ball("in/new.mha", radius=radius)
    os.rename("in/new.mha", "in/b.mha")
os.mkdir("fresh")
for command in (["isorender", "in/b.mha", "-o", "out.png"], ["isorender", "sheet", "in/b.mha", "in/c.mha", "-o", "out.html"]):
    def fresh():
        subprocess.run(command[:-1] + ["fresh/" + command[-1], "--quiet"], check=True)
        return open("fresh/" + command[-1], "rb").read()
    def drawn():
        return os.path.exists(command[-1]) and open(command[-1], "rb").read()
    replace_input(8.0)
    ball("in/c.mha", radius=8.0)
    p = subprocess.Popen(command + ["--quiet", "--watch"], stderr=subprocess.PIPE,
                         preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    first = fresh()
    until(lambda: drawn() == first)
    replace_input(5.0)
    second = fresh()
    expect(first != second)
    until(lambda: drawn() == second)
    open("in/new.mha", "w").write("hello")
    os.rename("in/new.mha", "in/b.mha") # what fails is said, and waited for
    expect(b"in/b.mha: not a MetaImage" in p.stderr.readline())
    replace_input(5.5)
    third = fresh()
    until(lambda: drawn() == third)
    p.send_signal(signal.SIGINT)
    expect(p.wait(timeout=30) == -signal.SIGINT, "an interrupt ends it: 130 in a shell", p.returncode)
P
