# Whatever ends the program, no copy of standard input is left; run.sh looks into TMPDIR.
for signal in TERM INT HUP KILL; do
    mkfifo in/pipe
    { printf 'ply\n'; head -c 3000000 /dev/zero; sleep 20; } >in/pipe &
    writer=$!
    isorender - out.png <in/pipe 2>/dev/null &
    reader=$!
    for i in $(seq 100); do
        ls -l /proc/$reader/fd 2>/dev/null | grep -q "$TMPDIR" && break
        sleep 0.05
    done
    [ "$i" -lt 100 ] || { echo "no copy was made in $TMPDIR"; exit 1; }
    kill -$signal $reader
    wait $reader && exit 1
    kill $writer 2>/dev/null || true
    rm in/pipe
    [ -z "$(ls -A "$TMPDIR")" ] || { ls -A "$TMPDIR"; exit 1; }
done
