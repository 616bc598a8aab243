python3 -c 'from check import *; ball("in/a.mha")'
isorender in/a.mha out.png --isovalue 500 --grid density --series 1 --quiet --json=j.json
python3 - <<'P'
from check import *
notes = " ".join(report("j.json")["volume"]["notes"])
expect("(--grid)" in notes and "(--series)" in notes, notes)
P
