# where memory is scarce the strips of a picture are shorter: a usual picture, of 4 samples a pixel, fits into 64 MB, and is the same
python3 -c 'from check import *; ball("in/ball.mha", side=48, radius=10.0)'
for look in "" "--method splats --samples 16" "--method pullpush --samples 4 --resolution 400x300" "--shading edl" "--method mesh --samples 9"; do
    isorender in/ball.mha whole.png $look --quiet
    isorender in/ball.mha strips.png $look --quiet --max-memory 64M --json=strips.json
    cmp whole.png strips.png
    python3 -c 'from check import *; peak = report("strips.json")["peak_bytes"]; expect(peak < 64e6, peak)'
done
