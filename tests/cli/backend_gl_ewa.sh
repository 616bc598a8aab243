# EWA splatting by OpenGL is that of the cpu, also of small discs, where the filter widens outlines; --lod is the cpu's
draw() { isorender scene:head:48 "$1" --method splats --reconstruction ewa --samples 1 --resolution 150x150 --quiet "${@:2}"; }
for zoom in 1 0.3; do draw cpu_$zoom.png --backend cpu --zoom $zoom; done
draw cpu_lod.png --backend cpu --lod 1 --zoom 0.3
tried=0
for backend in egl osmesa; do
    isorender --list-backends | grep "^$backend" | grep -qv 'cannot be used' || { echo "no $backend here"; continue; }
    for zoom in 1 0.3; do
        draw gl_$zoom.png --backend $backend --zoom $zoom
        isocompare images cpu_$zoom.png gl_$zoom.png --fail-under psnr=50 >/dev/null
    done
    draw gl_lod.png --backend $backend --lod 1 --zoom 0.3
    isocompare images cpu_lod.png gl_lod.png --fail-under psnr=45 >/dev/null
    tried=1
done
[ $tried = 1 ] || exit 77
