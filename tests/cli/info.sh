python3 -c 'from check import *; ball("in/ball.mha", header="ElementSpacing = 0.5 0.5 2\nOffset = 10 20 30\n")'
isorender --info in/ball.mha >text
for part in '24 x 24 x 24, float' 'spacing *0.5 0.5 2 mm' 'matrix' 'left-handed\|to world mm' 'range *0 ..' 'histogram.*#' 'isovalues' 'for the grid'; do
    grep -q "$part" text || { echo "no '$part' in:"; cat text; exit 1; }
done
isorender --info --json in/ball.mha >j.json
[ "$(ls)" = "$(printf 'in\nj.json\ntext')" ]
python3 - <<'P'
from check import *
j = report("j.json")
expect(sum(j["histogram"]["bins"]) == j["histogram"]["counted"], j["histogram"])
expect(j["matrix"] == [0.5, 0, 0, 10, 0, 0.5, 0, 20, 0, 0, 2, 30], j["matrix"])
expect(1 <= len(j["suggested_isovalues"]) <= 3 and j["memory"]["grid"] == 24 ** 3 * 4, j)
P
