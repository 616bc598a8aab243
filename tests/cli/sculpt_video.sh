# a video of the strokes as they are drawn, and of the result as it turns: as many pictures as said, the first is the beginning, the
# last of the strokes the result; what is wrong is refused before the work, and without ffmpeg by its name
command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null || { echo "skipped: there is no ffmpeg"; exit 0; }
cat > make.py <<'P'
import strokes as s
events = []
for z in (-20.0, 0.0, 20.0):
    events += [s.begin({"at": [24.0, 0.0, z], "normal": [1.0, 0.0, 0.0]}, radius=5.0), s.sample(at=[24.0, 8.0, z]), {"event": "end"}]
events += [s.begin({"at": [0.0, 0.0, 40.0]}, radius=12.0), {"event": "end"}, {"event": "undo"}]
s.write("three.strokes", events, s.header(voxel_size=1.0, dims=[96, 96, 96], origin=[-47.5] * 3))
s.write("none.strokes", [], s.header(voxel_size=1.0, dims=[96, 96, 96], origin=[-47.5] * 3))
P
python3 make.py
film() { isosculpt --headless --quiet --resolution 160x100 --frame-rate 10 --video "$@"; }
count() { ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames,width,height -of csv=p=0 "$1" | tr -d '\r'; }
film strokes.apng --replay three.strokes --seconds 1
film both.mp4 --replay three.strokes --seconds 1 --turntable 2 --mesh both.ply
film turn.apng --new box:40x30x20 --turntable 0.8
film edited.apng --replay three.strokes --seconds 1 --mute 1-3
film one.apng --replay three.strokes --seconds 1 --threads 1
[ "$(count strokes.apng)" = "160,100,10" ] && [ "$(count both.mp4)" = "160,100,30" ] && [ "$(count turn.apng)" = "160,100,8" ] ||
    { count strokes.apng; count both.mp4; count turn.apng; exit 1; }
cmp strokes.apng one.apng
[ -s both.ply ]
frame() { ffmpeg -v error -y -i "$1" -vf "select=eq(n\\,$2)" -frames:v 1 -f rawvideo -pix_fmt rgb24 "$3"; }
for i in 0 4 9; do frame strokes.apng $i s$i.raw; frame edited.apng $i e$i.raw; done
for i in 0 2 4; do frame turn.apng $i t$i.raw; done
cmp e0.raw e9.raw     # all strokes are muted: nothing happens
! cmp -s s0.raw s4.raw && ! cmp -s s4.raw s9.raw
! cmp -s t0.raw t2.raw
python3 - <<'Q'   # a box looks the same from behind, but not from the side
a, b, c = (open("t%d.raw" % i, "rb").read() for i in (0, 2, 4))
off = lambda u, v: sum(abs(x - y) > 8 for x, y in zip(u, v)) / len(u)
assert off(a, c) < 0.002 < 0.02 < off(a, b), (off(a, c), off(a, b))
Q
# the last picture is what the result looks like, alone at the same place
film still.apng --replay three.strokes --seconds 0.2
frame still.apng 1 last.raw
cmp s9.raw last.raw
refused() { # STATUS WORDS ARGUMENTS
    local code=0
    isosculpt --headless --quiet "${@:3}" 2>message || code=$?
    [ "$code" = "$1" ] && [ "$(wc -l <message)" = 1 ] && grep -q "$2" message || { echo "$*: $code"; cat message; exit 1; }
}
refused 2 "videos are" --replay three.strokes --video film.avi
refused 2 "pictures" --replay three.strokes --video film.mp4 --seconds 0.04
refused 2 "odd\|even" --replay three.strokes --video film.mp4 --resolution 161x100
refused 2 "three.strokes" --replay three.strokes --video three.strokes
mkdir -p empty
code=0
PATH=$PWD/empty "$(command -v isosculpt)" --headless --quiet --replay three.strokes --video film.mp4 --mesh film.ply 2>message || code=$?
[ "$code" = 4 ] && grep -q ffmpeg message && [ ! -e film.mp4 ] && [ ! -e film.ply ] || { echo "$code"; cat message; exit 1; }
code=0
isosculpt --video film.mp4 2>message || code=$?
[ "$code" = 2 ] && grep -q "needs --headless" message
