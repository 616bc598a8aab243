# On a terminal progress is shown by itself, with true fractions while a picture is drawn, and is gone in the end.
cat >in/terminal.py <<'P'
"""Runs a command with a terminal as its standard error and prints what that got."""
import os, pty, subprocess, sys
master, slave = pty.openpty()
environment = dict(os.environ, TERM=sys.argv[1])
child = subprocess.Popen(sys.argv[2:], stderr=slave, env=environment)
os.close(slave)
said = b""
while True:
    try:
        piece = os.read(master, 4096)
    except OSError:
        break
    if not piece:
        break
    said += piece
code = child.wait()
sys.stdout.buffer.write(said)
sys.exit(code)
P
slow=(isorender scene:gyroid:96 out.png --method raycast --samples 16 --resolution 500x500 --threads 1)
python3 in/terminal.py xterm "${slow[@]}" >said
python3 - <<'P'
import re
from check import *
said = open("said", "rb").read().decode()
shares = [int(n) for n in re.findall(r"rendering +\[#* *\] +(\d+) %", said)]
expect(len(shares) > 5 and shares == sorted(shares) and shares[-1] < 100, shares)
expect("\r\033[K" in said and said.endswith("wrote out.png\r\n"), said[-200:])
shown = re.sub(r"[^\n]*\r\033\[K", "", said)
expect("rendering" not in shown, shown)
P
python3 in/terminal.py xterm isorender scene:torus:32 out.png --resolution 32x32 --progress --quiet >said
[ ! -s said ]
python3 in/terminal.py dumb isorender scene:torus:32 out.png --resolution 32x32 >said
! grep -q $'\r'[^$'\n'] said && ! grep -q $'\033' said
isorender scene:torus:32 out.png --resolution 32x32 2>log
! grep -q '%' log
"${slow[@]}" --progress 2>log
grep -q 'rendering 40 %' log && grep -q 'rendering 80 %' log && ! grep -q $'\r' log
