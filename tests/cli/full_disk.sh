# exit: 7
# stderr: isorender: in/disk/out.png: cannot write: No space left on device
mkdir in/disk
mount -t tmpfs -o size=16k tmpfs in/disk 2>/dev/null || { echo "skipped: cannot mount a small file system here"; exit 77; }
status=0
isorender scene:torus:32 in/disk/out.png --quiet || status=$?
left=$(ls -A in/disk)
umount in/disk
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
exit $status
