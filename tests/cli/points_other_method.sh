# exit: 2
# stderr: isorender: in/p.ply: holds points, not a volume: --method mesh needs a volume; points, pullpush, discs or splats draw them
isorender --quiet scene:sphere:32 --points in/p.ply --no-image
for method in exact raycast; do
    ! isorender in/p.ply --method $method 2>in/message || exit 1
    grep -q "holds points, not a volume: --method $method needs a volume" in/message
done
isorender in/p.ply in/p.png --method discs --quiet --resolution 50x50
isorender in/p.ply --method mesh
