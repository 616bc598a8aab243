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
P
python3 in/cases.py
