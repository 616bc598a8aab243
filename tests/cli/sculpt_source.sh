# the source of a stroke file is a regular file: nothing else is waited for or read without end; a failure names both
cat > in/cases.py <<'P'
from strokes import *
import os, socket, subprocess
os.mkfifo("in/pipe")
os.mkdir("in/folder")
listener = socket.socket(socket.AF_UNIX)
listener.bind("in/socket")
open("in/text.nrrd", "w").write("no volume\n")
crc = crc32c(b"no volume\n")
for source in "/dev/zero", "in/pipe", "in/socket", "in/none.nrrd", "in/folder", "in/text.nrrd":
    path = "in/source.strokes"
    write(path, [begin(), {"event": "end"}],
          header(source=source, radius=0, source_crc=crc if source == "in/text.nrrd" else 0))
    done = subprocess.run(["isosculpt", "--replay", path, "--headless"], capture_output=True, text=True, timeout=60)
    text = done.stderr
    assert done.returncode == 3 and text.count("\n") == 1 and path in text and source in text, (source, done)
for path in "/dev/zero", "in/folder":  # as the stroke file itself
    done = subprocess.run(["isosculpt", "--replay", path, "--headless"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 3 and done.stderr.count("\n") == 1 and path in done.stderr, done
P
python3 in/cases.py
