python3 -c 'from check import *; ball("in/ball.mha", 64, 20)'
mkfifo in/pipe
cat in/ball.mha >in/pipe &
isorender in/pipe a.png --quiet --resolution 100x100
isorender in/ball.mha b.png --quiet --resolution 100x100
python3 - <<'P'
from check import *
expect(Png("a.png").rows == Png("b.png").rows, "pictures differ")
P
