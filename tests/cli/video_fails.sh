# What goes wrong with a video is one line, and leaves no file.
bad() { refuses "$1" "$2" isorender scene:torus:32 "$3" --turntable 9 --quiet --resolution 200x200 "${@:4}"; }
mkdir in/none in/dies in/killed in/silent in/short
printf '#!/bin/sh\nhead -c 1000 >/dev/null\necho "[x @ 0x1] it broke" >&2\necho "more" >&2\nexit 1\n' >in/dies/ffmpeg
printf '#!/bin/sh\nkill -9 $$\n' >in/killed/ffmpeg
printf '#!/bin/sh\nexit 3\n' >in/silent/ffmpeg
printf '#!/bin/sh\ncat >/dev/null; echo "it could not" >&2\n' >in/short/ffmpeg # says so only at the end, and exits with 0
chmod +x in/*/ffmpeg
programs=$(dirname "$(command -v isorender)")
for case in "dies|7|bad.mp4: cannot write: ffmpeg: it broke$" "killed|7|ffmpeg: it was ended by signal 9" \
    "silent|7|ffmpeg: it ended too early" "short|7|ffmpeg: it could not"; do
    IFS='|' read -r folder status text <<<"$case"
    (PATH=$PWD/in/$folder:$PATH; bad "$status" "$text" bad.mp4)
done
(
    mkdir in/tools
    for tool in bash wc grep ls cat env; do ln -s "$(command -v $tool)" in/tools/; done
    PATH=$PWD/in/tools:$programs
    bad 4 "bad.gif: videos are encoded by ffmpeg, which is not there (Debian's package is ffmpeg)" bad.gif
)
command -v ffmpeg >/dev/null || exit 0
# a film that was there before stays as it is
isorender scene:torus:32 old.mp4 --turntable 2 --resolution 32x32 --quiet
cp old.mp4 in/
(ulimit -f 2; bad 7 "bad.mp4: cannot write: ffmpeg: .*File too large" bad.mp4)
(ulimit -f 2; bad 7 "File too large" old.mp4)
cmp old.mp4 in/old.mp4
rm old.mp4
[ "$(ls -A)" = "$(printf 'in\nsaid')" ]
# the work after the video fails: it goes, too
bad 7 "cannot write" bad.webm --json=/dev/full
if mkdir in/disk && mount -t tmpfs -o size=4k tmpfs in/disk 2>/dev/null; then
    code=0
    bad 7 "No space left on device" in/disk/bad.mp4 || code=1
    left=$(ls -A in/disk)
    umount in/disk
    [ -z "$left" ] && [ $code = 0 ]
fi
