# strokes that invert and clear the whole mask: only what a mask left free can be carved, and after clearing everything
cat >in/masks.py <<'P'
from strokes import *
end = {"event": "end"}
def stroke(tool, at=(20.0, 0.0, 0.0), **changes):
    return [begin({"at": list(at)}, tool=tool, **changes), end]
left, right = (-20.0, 0.0, 0.0), (20.0, 0.0, 0.0)
mask, carving = stroke("mask", right, radius=16.0), stroke("carve", right) + stroke("carve", left)
write("in/nothing.strokes", [])
write("in/left.strokes", stroke("carve", left))
write("in/right.strokes", stroke("carve", right))
write("in/both.strokes", carving)
write("in/masked.strokes", mask + carving)
write("in/inverted.strokes", mask + stroke("invert-mask") + carving)
write("in/undone.strokes", mask + stroke("invert-mask") + [{"event": "undo"}] + carving)
write("in/cleared.strokes", mask + stroke("invert-mask") + stroke("clear-mask") + carving)
write("in/frozen.strokes", stroke("invert-mask") + carving)
# a stroke of such a tool changes the mask once, however long it is
write("in/once.strokes", mask + [begin(tool="invert-mask")] + [sample(at=[i, 0, 0]) for i in range(20)] + [end] + carving)
P
python3 in/masks.py
for name in nothing left right both masked inverted undone cleared frozen once; do
    isosculpt --replay in/$name.strokes --headless --mesh $name.stl --quiet
done
same() { cmp $1.stl $2.stl || { echo "$1 is not $2"; exit 1; }; }
same frozen nothing
same masked left
same undone left
same inverted right
same once right
same cleared both
! cmp -s left.stl right.stl
