# a stroke of the mask that leads far away from the grid takes time for the touches in the grid only
cat >in/far.py <<'P'
from strokes import *
events = [begin(tool="mask", radius=1.0), sample(at=[0, 0, 5]), sample(at=[0, 0, 60000]), {"event": "end"}]
write("in/far.strokes", events)
P
python3 in/far.py
(ulimit -t 4 && isosculpt --replay in/far.strokes --headless --output a.vdb --threads 1 --quiet)
