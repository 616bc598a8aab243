#!/bin/bash
# The gl engine in a real window under Xvfb: compares its pictures with the cpu engine's of the same field, while mouse and
# keys sculpt, change the method and resize; the driver must report nothing. gl.sh BIN TOOLS. Exit status 77: skipped.
set -u
. "$(dirname "$0")/support.sh"
"$bin/isosculpt" --headless --backend gl --open x.vdb 2>"$work/said"
[ $? -eq 2 ] || fail "--backend gl without a window is no wrong usage"
require_window
open_display
cd "$work" || exit 1
export ISO_GL_DEBUG=1

# ---- an OpenGL version that is too old is reported, or the cpu engine is used
MESA_GL_VERSION_OVERRIDE=4.4 MESA_GLSL_VERSION_OVERRIDE=440 timeout "$LIMIT" "$bin/isosculpt" --backend gl 2>"$work/said"
code=$?
grep -q "glad" "$work/said" && { echo "skipped: built without glad"; exit 77; }
[ $code -eq 4 ] && grep -q "4\.5 is needed" "$work/said" || fail "OpenGL 4.4: exit status $code"
anew

# close_window: closes the window; fails if the driver reported more than notifications
close_window() {
    key ctrl+q
    key Return
    closing=$program
    program=
    until_ "closing" has_ended "$closing"
    grep -q "OpenGL: 0 messages" "$work/said" || fail "the driver has something to say"
}
# agree A B: whether the PSNR of two pictures is 40 dB or more
agree() {
    "$bin/isocompare" images "$work/$1.png" "$work/$2.png" --fail-under psnr=40 >"$work/compared" || {
        cat "$work/compared"
        fail "$1 and $2 differ"
    }
    grep '^psnr ' "$work/compared" | sed "s/^/$1, $2: /"
}
size_of() { od -An -j16 -N8 -tx1 "$work/$1.png" | tr -d ' \n'; }
# both NAME: takes the picture with both engines; gl is active before and after
both() {
    picture "gl_$1"
    key g
    picture "cpu_$1"
    key g
}
# all_methods NAME: takes the pictures of all methods, and compares those of both engines (at rest, exact is drawn by the cpu engine)
all_methods() {
    local method
    for method in exact discs pullpush box points mesh; do
        both "$1_$method"
        key m
    done
    cmp "$work/gl_$1_exact.png" "$work/cpu_$1_exact.png" || fail "exact is not exact"
    for method in discs pullpush box points mesh; do
        agree "cpu_$1_$method" "gl_$1_$method"
    done
}

start --backend gl
picture new
all_methods new

# ---- edges at rest have four samples, by the gl engine, too
key m m m m m
xdotool mousemove 1270 790 sleep 2
whole_window rest
look smooth rest.png 304,150,1280,650 || fail "edges at rest are jagged"
key m

# ---- strokes with each method, which picks positions from its own picture; undo restores the first picture
for method in exact discs pullpush box points mesh; do
    stroke 640 400 30 20
    picture "stroke_$method"
    cmp -s "$work/stroke_$method.png" "$work/gl_new_$method.png" && fail "$method: the stroke is not to be seen"
    key ctrl+z
    picture "undone_$method"
    cmp "$work/undone_$method.png" "$work/gl_new_$method.png" || fail "$method: undo left something"
    key m
done
stroke 640 400 60 40
drag 1 1100 650 60 40
all_methods sculpted
cmp -s "$work/gl_sculpted_mesh.png" "$work/gl_new_mesh.png" && fail "nothing was sculpted"

# ---- frozen parts are drawn darker; by the cpu engine
key m m m m m
picture free
key 9
stroke 560 300 30 20
picture frozen
cmp -s "$work/free.png" "$work/frozen.png" && fail "what is frozen does not look it"
key ctrl+z
picture thawed
cmp "$work/free.png" "$work/thawed.png" || fail "thawed: another picture"
key m

# ---- with the reference, the cpu engine draws all methods
key r
through() {
    press 62 526
    press 50 575
    picture through
    differ through gl_sculpted_exact
}
until_ "the reference through the sculpture" through
for method in exact discs pullpush box; do
    both "reference_$method"
    cmp "$work/gl_reference_$method.png" "$work/cpu_reference_$method.png" || fail "reference, $method: not the cpu engine's"
    differ "gl_reference_$method" "gl_sculpted_$method" || fail "reference, $method: it is not to be seen"
    key m
done
key r m m

# ---- another size
xdotool search --onlyvisible --name '^isosculpt' windowsize --sync 701 523
has_size() { picture resized && [ "$(size_of resized)" = 0000018d0000020b ]; } # without the panel
until_ "pictures of 397 x 523" has_size
all_methods resized
close_window

# ---- a software OpenGL renderer is not chosen automatically: the cpu engine is used
anew # (the journal to look at is the one that will be there)
start
key m m m m m
picture automatic
cmp "$work/automatic.png" "$work/cpu_new_mesh.png" || fail "auto is not the cpu engine here"
close_window
echo "passed"
