# Several samples a pixel: the picture in chunks, and that of merged parts, has the bytes of the whole one. Opaque
# surfaces by exact have 4 when nothing is said, others 1.
draw() { isorender scene:ct:48 "$1" --resolution 91x77 --quiet "${@:2}"; }
for samples in 1 4 9; do
    for method in exact "pullpush --reconstruction gaussian" "pullpush --reconstruction box"; do
        for look in "" "--background none" "--background 204060"; do
            set -- --method $method --samples $samples $look
            draw whole.png "$@" --fit box # as parts and chunks do when nothing is said
            draw chunks.png --chunk-size 32 "$@"
            for part in 1 2 3; do draw $part.isokeys --part $part/3 "$@"; done
            isorender merge [123].isokeys -o merged.png --quiet
            python3 - "$*" <<'P'
import sys
from check import *
whole = Png("whole.png").rows
for name in ("chunks.png", "merged.png"):
    expect(Png(name).rows == whole, sys.argv[1], name)
P
        done
    done
done
count() { draw usual.png --json "$@" | python3 -c 'import json, sys; print(json.load(sys.stdin)["image"]["samples"])'; }
[ "$(count)" = 4 ]
[ "$(count --opacity 0.5)" = 1 ]
[ "$(count --ior 1.5)" = 1 ]
[ "$(count --method pullpush)" = 1 ]
[ "$(count --samples 1)" = 1 ]
draw usual.png
draw four.png --samples 4
python3 -c 'from check import *; expect(Png("usual.png").rows == Png("four.png").rows)'
