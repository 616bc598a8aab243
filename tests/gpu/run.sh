#!/usr/bin/env bash
# run.sh BIN OUT [SECONDS]: the gl engine on this machine's GPU, in at most ten minutes: the tests of the engine, every method's
# picture by the GPU beside the processor's (43 dB asked), and frames per second. BIN: the programs of a build with tests.
# Writes OUT/report.txt, which is printed, and OUT/log.txt. Exit status 1: something fell short; 77: EGL finds no GPU.
set -u
bin=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
here=$(cd "$(dirname "$0")/../.." && pwd)
end=$((SECONDS + ${3:-570}))
report=$out/report.txt
short=0
: >"$report"
say() { printf '%s\n' "$*" | tee -a "$report"; }
# run SECONDS COMMAND..: within this time and what is left of the whole
run() {
    local most=$1 left=$((end - SECONDS))
    shift
    [ "$left" -gt 5 ] || return 124
    echo "\$ $*" >>"$out/log.txt"
    timeout -k 5 $((most < left ? most : left)) "$@" >>"$out/log.txt" 2>&1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/isorender" --list-backends >"$work/backends" 2>&1
sed 's/^/    /' "$work/backends" | tee -a "$report"
if ! grep '^egl.*OpenGL 4' "$work/backends" | grep -qv 'llvmpipe\|softpipe\|swrast'; then
    say "EGL finds no GPU"
    exit 77
fi

say "" "Tests of the engine"
for test in gl gl_canvas gl_robust gl_spans gl_pullpush gl_splats gl_selection gl_shapes sculpt_gl; do
    began=$SECONDS
    run 60 "$bin/test_$test"
    status=$?
    [ $status -eq 0 ] || short=1
    say "    $test: $([ $status -eq 0 ] && echo passed || echo "FAILED with $status") in $((SECONDS - began)) s"
done

say "" "Pictures of 1024 x 1024 by the GPU and by the processor, dB; seconds of the whole command by each"
# compare NAME INPUT OPTION..
compare() {
    local name=$1 began middle
    shift
    began=$(date +%s%N)
    run 60 "$bin/isorender" "$@" "$work/cpu.png" --resolution 1024x1024 --quiet --backend cpu || { say "    $name: not by the processor"; return; }
    middle=$(date +%s%N)
    if ! run 60 "$bin/isorender" "$@" "$work/gpu.png" --resolution 1024x1024 --quiet --backend egl; then
        say "    $name: FAILED by the GPU: $(tail -n 1 "$out/log.txt")"
        short=1
        return
    fi
    local after psnr
    after=$(date +%s%N)
    psnr=$("$bin/isocompare" images "$work/cpu.png" "$work/gpu.png" 2>>"$out/log.txt" | awk '$1 == "psnr" { print $2 }')
    awk -v p="${psnr:-0}" 'BEGIN { exit !(p == "identical" || p >= 43) }' || { short=1; psnr="$psnr SHORT"; cp "$work/cpu.png" "$out/$name-cpu.png"; cp "$work/gpu.png" "$out/$name-gpu.png"; }
    say "    $name: $psnr dB, $(awk -v a=$((middle - began)) -v b=$((after - middle)) 'BEGIN { printf "%.2f s by the processor, %.2f by the GPU", a / 1e9, b / 1e9 }')"
}
for scene in gyroid:192 head:192 ct:256; do
    for view in 1 4; do
        for method in points discs splats mesh; do
            compare "$scene-$view-$method" "scene:$scene" --method $method --zoom $view
        done
        compare "$scene-$view-pullpush" "scene:$scene" --method pullpush --zoom $view
        compare "$scene-$view-visible" "scene:$scene" --method splats --selection visible --zoom $view
    done
done
for method in pullpush discs; do
    compare "two-surfaces-$method" scene:ct:128 --isovalue 60,150 --method $method
done
compare stent "$here/volumes/stent.nrrd" --isovalue 600 --method discs

say "" "Frames of 800 x 800 of a bumpy sphere, milliseconds"
run 200 "$bin/bench" render --filter gl_ --repeat 5 --json "$out/bench.json"
grep -E '^ *render/gl_|limit of|asked' "$out/log.txt" | tee -a "$report"
say "" "$([ $short -eq 0 ] && echo "nothing fell short" || echo "something fell short") in $SECONDS s"
exit $short
