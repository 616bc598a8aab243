# Pictures of parts, merged in any order, are the bytes of the whole picture: for every number of parts, camera, instruction
# set and number of threads, with annotations, and of cropped and anisotropic volumes.
python3 - <<'P'
import itertools
import math
import os
import random
import subprocess
from check import *

random.seed(1)
volume("in/waves.mha", (90, 70, 83), lambda x, y, z: 100 * math.sin(x / 5) * math.cos(y / 4) + 50 * math.sin(z / 3 + x / 9),
       header="ElementSpacing = 0.7 1.9 1.2\nOffset = -5 3 11\n")
cameras = [["--camera", "iso"], ["--orthographic", "--azimuth", "30", "--fit", "tight", "--scale-bar"],
           ["--camera-position", "20,60,40", "--camera-focal-point", "60,10,30", "--view-angle", "90", "--orientation-marker"]]
inputs = [["in/waves.mha", "--isovalue", "20"], ["scene:ct:96"], ["in/waves.mha", "--isovalue", "-31", "--crop", "7,80,3,66,1,77"],
          ["scene:gyroid:64", "--background", "none", "--color", "ivory"],
          ["scene:ct:96", "--method", "pullpush", "--reconstruction", "gaussian", "--background", "222222"],
          ["in/waves.mha", "--isovalue", "20", "--method", "pullpush", "--reconstruction", "box"]]
levels = ["generic", "avx2", "avx512"]


def run(arguments, level=None, last=()):
    environment = dict(os.environ, **({"ISO_CPU": level} if level else {}))
    subprocess.run(["isorender", *arguments, "--resolution", "200x150", "--quiet", *last], check=True, env=environment)


for number, (what, camera, parts) in enumerate(zip(itertools.cycle(inputs), itertools.cycle(cameras), [1, 2, 3, 5, 8, 8, 5, 3, 2, 7, 3, 2])):
    level, threads = levels[number % 3], str([1, 2, 7][number // 3 % 3])
    # what a part frames when nothing is said, and its file states
    run([*what, "whole.png", *camera], last=["--fit", "box"] if camera == cameras[0] else [])
    names = ["%d.isokeys" % k for k in range(1, parts + 1)]
    for k, name in enumerate(names):
        side = [] if parts == 1 else ["--chunk-size", str(random.choice([16, 32, 48]))]
        if k == 0 and side:
            sides = side
        run([*what, *camera, "--part", "%d/%d" % (k + 1, parts), "-o", name, "--threads", threads, *(sides if side else [])], level)
    random.shuffle(names)
    subprocess.run(["isorender", "merge", *names, "-o", "merged.png", "--quiet"], check=True)
    expect(open("whole.png", "rb").read() == open("merged.png", "rb").read(), what, camera, parts)
P
# without -o the part is in the file's name
isorender scene:ct:48 --part 2/3 --quiet
[ -s ct-2-of-3.isokeys ] || [ -s "$(ls *-2-of-3.isokeys)" ]
