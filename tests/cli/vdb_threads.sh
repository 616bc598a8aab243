# Where no thread can be made, a .vdb is read by one thread, or there is no memory: exit 0 or 5, and one line. Nothing aborts.
isosculpt --headless --replay "$volumes/bear.strokes" --voxel-size 4 -o in/s.vdb --quiet 2>said || { grep -q "OpenVDB" said && exit 77; cat said; exit 1; }
isorender in/s.vdb whole.png --quiet --threads 1 --resolution 64x64
limited() { # limited ULIMIT..: with this limit, and any number of threads
    local code=0 threads
    for threads in 1 4; do
        rm -f out.png
        (ulimit "$@"; exec isorender --quiet --threads $threads in/s.vdb out.png --resolution 64x64) >said 2>&1 || code=$?
        if [ $code = 0 ] && [ ! -s said ] && cmp -s out.png whole.png; then continue; fi
        [ $code = 5 ] && [ "$(grep -c '' said)" = 1 ] && [ ! -e out.png ] && continue
        echo "ulimit $*, $threads threads: exit $code: $(cat said)"
        exit 1
    done
}
for kilobytes in 4096 8192 16384 32768 65536 131072; do limited -d $kilobytes; done
for kilobytes in 80000 100000 150000 200000 300000; do limited -v $kilobytes; done
