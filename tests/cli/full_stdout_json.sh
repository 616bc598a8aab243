isorender scene:torus:32 --no-image --json --quiet >/dev/full
