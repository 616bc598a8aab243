# The pictures of a turntable as a video, encoded by ffmpeg while they are drawn.
command -v ffmpeg >/dev/null || { echo "skipped: no ffmpeg"; exit 77; }
draw() { isorender scene:torus:32 --isovalue 0 --turntable 5 --camera iso --resolution 160x120 "$@"; }
draw t.png --quiet
draw t.mp4 2>log
grep -q 'wrote t.mp4: 5 pictures$' log
for type in webm gif apng; do draw t.$type --quiet; done
md5() { ffmpeg -v error "$@" -map 0:v -pix_fmt rgb24 -f framemd5 - | grep -v '^#' | sed 's/.*, //'; }
# without loss the pictures are those that are written one by one, in their order
md5 -i t_%03d.png >all
[ "$(sort -u all | wc -l)" = 5 ]
md5 -i t.apng | cmp - all
for type in mp4 webm gif; do
    [ "$(md5 -i t.$type | wc -l)" = 5 ]
    ffmpeg -v error -ss 0.12 -i t.$type -frames:v 1 $type.png
    isocompare images t_003.png $type.png --quiet --fail-under psnr=30
done
# the rate, and the title and the command
draw slow.mp4 --frame-rate 7.5 --quiet
ffprobe -v error -show_entries stream=r_frame_rate,color_space,color_range -show_entries format_tags=title,comment slow.mp4 >said
grep -q 'r_frame_rate=15/2' said && grep -q 'color_space=bt709' said && grep -q 'title=torus' said && grep -q 'comment=isorender .*--turntable' said
# the same bytes on any number of threads; a template; with --json each frame's hash
draw t1.mp4 --quiet --threads 1
cmp t.mp4 t1.mp4
draw -o '{model}.mp4' --quiet --json=j.json
cmp t.mp4 torus.mp4
python3 -c 'from check import *; j = report("j.json"); expect(len(j["frames"]) == 5 and j["frames"][4]["path"] == "torus.mp4", j["frames"])'
# what is transparent stays so
draw clear.apng --no-background --quiet
ffmpeg -v error -i clear.apng -frames:v 1 -pix_fmt rgba clear.png
draw cleared.png --no-background --quiet
ffmpeg -v error -i cleared_000.png -frames:v 1 -pix_fmt rgba -f framemd5 - | tail -1 >a
ffmpeg -v error -i clear.png -frames:v 1 -pix_fmt rgba -f framemd5 - | tail -1 | cmp - a
