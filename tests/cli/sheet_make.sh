# The example of make in docs/sheets.md, as it stands there: red panels do not stop it, and only what changed is drawn again.
command -v make >/dev/null || { echo "skipped: no make"; exit 77; }
sed -n '/^```make$/,/^```$/p' "$(dirname "$volumes")/docs/sheets.md" | sed '/^```/d' >Makefile
grep -q "isorender sheet" Makefile
python3 - <<'P'
from check import *
for i in range(3):
    ball("in/b%d.mha" % i, radius=4.0 + i)
open("in/broken.mha", "w").write("hello")
P
make >log 2>said
grep -q "in/broken.mha: not a MetaImage" said
cp qc.html first.html
make | grep -q "up to date"
sleep 1.1
python3 -c 'from check import *; ball("in/b1.mha", radius=8.0)'
make >log 2>said
cmp -s qc.html first.html && exit 1
python3 - <<'P'
import json
lines = [json.loads(line) for line in open("qc.jsonl")]
assert [(j["status"], j["kept"]) for j in lines] == [(0, True), (0, False), (0, True), (3, False)], lines
P
rm qc.html
sed -i 's/ || .*//' Makefile
make >log 2>said && exit 1
grep -q "Error 3" said
