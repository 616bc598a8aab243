python3 -c 'from check import *; ball("in/ball.mha")'
isorender in/ball.mha cpu.png --isovalue 500 --method points --backend cpu --json --quiet >cpu.json
isorender in/ball.mha cpu_pull.png --isovalue 500 --method pullpush --reconstruction gaussian --backend cpu --json \
    --quiet >cpu_pull.json
isorender in/ball.mha cpu_discs.png --isovalue 500 --method discs --backend cpu --quiet
for how in sorted groups nearest; do
    isorender in/ball.mha cpu_$how.png --isovalue 500 --method splats --opacity 0.5 --transparency $how --samples 4 --quiet
done
tried=0
for backend in egl osmesa; do
    isorender --list-backends | grep "^$backend" | grep -qv 'cannot be used' || { echo "no $backend here"; continue; }
    isorender in/ball.mha $backend.png --isovalue 500 --backend $backend --samples 4 --json --quiet >$backend.json
    isorender in/ball.mha $backend.png --isovalue 500 --backend $backend --json --quiet >$backend.json
    isorender in/ball.mha --isovalue 500 --backend $backend --method mesh --turntable 3 -o 'mesh_{n}.png' --quiet
    isorender in/ball.mha mesh.png --isovalue 500 --backend $backend --method mesh --json --quiet >mesh.json
    isorender in/ball.mha strips.png --isovalue 500 --backend $backend --strips --json --quiet >strips.json
    isorender in/ball.mha wide.png --isovalue 500 --backend $backend --point-scaling attenuated --json --quiet >wide.json
    isorender in/ball.mha pull.png --isovalue 500 --backend $backend --method pullpush --reconstruction gaussian \
        --json --quiet >pull.json
    isorender in/ball.mha discs.png --isovalue 500 --backend $backend --method discs --json --quiet >discs.json
    isocompare images cpu_discs.png discs.png --fail-under psnr=40 >/dev/null
    for how in sorted groups nearest; do
        isorender in/ball.mha $how.png --isovalue 500 --method splats --opacity 0.5 --transparency $how --samples 4 --backend $backend \
            --json --quiet >$how.json
        isocompare images cpu_$how.png $how.png --fail-under psnr=43 >/dev/null
    done
    BACKEND=$backend python3 - <<'P'
import os
from check import *
backend = os.environ["BACKEND"]
cpu, gl, wide = report("cpu.json"), report(backend + ".json"), report("wide.json")
cpu_pull, pull = report("cpu_pull.json"), report("pull.json")
expect(gl["backend"] == backend and gl["renderer"] and gl["gl"]["messages"] == 0, gl)
mesh, strips = report("mesh.json"), report("strips.json")
expect(strips["method"] == "mesh" and "strip_indices" not in mesh["gl"], strips["method"])
expect(strips["image"]["covered"] == mesh["image"]["covered"], strips["image"])
percent = strips["gl"]["strip_indices"] / strips["primitives"]["triangles"] / 3 * 100
expect(abs(percent - strips["gl"]["strip_percent"]) < 1e-6, strips["gl"])
expect(30 < strips["gl"]["strip_percent"] < 55, strips["gl"])
a, b = cpu["image"]["covered"], gl["image"]["covered"]
expect(abs(a - b) <= 30, (a, b))
expect(list(gl["gl"]["seconds"]) == ["draw"] and gl["gl"]["seconds"]["draw"] > 0, gl["gl"])
expect(gl["gl"]["vendor"] and gl["gl"]["version"], gl["gl"])
expect(list(pull["gl"]["seconds"]) == ["project", "pull", "push", "finish"], pull["gl"])
for how in "sorted", "groups", "nearest":
    expect(report(how + ".json")["backend"] == backend and report(how + ".json")["gl"]["messages"] == 0, how)
discs = report("discs.json")
expect(list(discs["gl"]["seconds"]) == ["front", "add", "resolve"], discs["gl"])
expect(discs["gl"]["messages"] == 0, discs["gl"])
a_pull, b_pull = cpu_pull["image"]["covered"], pull["image"]["covered"]
expect(abs(a_pull - b_pull) <= 30, (a_pull, b_pull))
expect(b < wide["image"]["covered"] < 1.05 * b, (b, wide["image"]["covered"]))
P
    tried=$((tried + 1))
done
[ $tried -gt 0 ] || exit 77
