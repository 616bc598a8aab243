python3 -c 'from check import *; ball("in/ball.mha")'
isorender - - --quiet --resolution 100x100 <in/ball.mha >a.png
isorender in/ball.mha b.png --quiet --resolution 100x100
python3 - <<'P'
from check import *
a, b = Png("a.png"), Png("b.png")
expect(a.rows == b.rows, "pictures differ")
expect(a.texts["Title"] == "stdin" and b.texts["Title"] == "ball", a.texts, b.texts)
P
