# No file may grow at all: status 7 and one line from every program, whatever the output is.
isorender scene:sphere:32 in/a.png --resolution 64x64 --quiet
isorender scene:torus:32 in/b.png --resolution 64x64 --quiet
python3 - <<'P'
import os
import resource
import subprocess
from check import *

ball("in/ball.mha", 64, 20)
for command in ("isorender scene:sphere:32 out.png", "isorender in/ball.mha out.png", "isorender scene:sphere:32 --no-image --points p.ply",
                "isorender scene:sphere:32 --no-image --mesh m.stl", "isorender scene:sphere:32 --info --json=j.json",
                "isorender in/ball.mha --part 1/2 -o o.isokeys", "isorender in/ball.mha --turntable 2 -o o.png",
                "isocompare images in/a.png in/b.png --difference d.png --json=j.json",
                "isocompare report scene:sphere:32 --side 64 --output report",
                "isosculpt --headless --open in/ball.mha --isovalue 100 --voxel-size 2 -o s.stl",
                "isosculpt --headless --open in/ball.mha --isovalue 100 --voxel-size 2 -o s.vdb"):
    done = subprocess.run(command.split() + ["--quiet"], capture_output=True, text=True, timeout=60,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
    expect(done.returncode == 7 or (command.endswith(".vdb") and "OpenVDB" in done.stderr), (command, done))
    expect(done.stderr.count("\n") == 1 and not done.stdout, (command, done))
    expect(sorted(os.listdir(".")) == ["in"], (command, os.listdir(".")))
P
