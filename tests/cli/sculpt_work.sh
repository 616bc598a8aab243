# what a hand makes at the edges of the window (its smallest and largest brushes, three mirrors, long drags) is played
cat > in/cases.py <<'P'
from strokes import *
import subprocess
end = {"event": "end"}
ways = [sample(at=[(-1) ** i * 60.0, i - 10.0, 0]) for i in range(4)]
hand = [begin(radius=4.0)] + ways + [end, begin(tool="inflate", radius=4.0, symmetry=7)] + ways + [
    end, begin(radius=512.0, tool="mask"), end, begin(radius=512.0, tool="unmask"), end,
    begin(tool="smooth", radius=512.0), end, begin(tool="move", radius=4.0)] + ways + [end]
write("in/hand.strokes", hand)
done = subprocess.run(["isosculpt", "--replay", "in/hand.strokes", "--headless", "-q"], capture_output=True, text=True)
assert done.returncode == 0, done
# a long drag of a small brush does not gather a window of the field as large as the drag
drag = [begin({"at": [57.5] * 3}, tool="move", radius=6.0), sample(at=[400, 420, 440]), end]
write("in/drag.strokes", drag, header(voxel_size=1.0, dims=[1024] * 3, origin=[-511.5] * 3, radius=100.0))
subprocess.run(["isosculpt", "--replay", "in/drag.strokes", "--headless", "-q", "--threads", "2", "--json=in/drag.json"],
               check=True)
peak = json.load(open("in/drag.json"))["peak_bytes"]
assert peak < 300e6, peak
P
python3 in/cases.py
