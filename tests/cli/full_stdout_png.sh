isorender scene:torus:32 - --quiet >/dev/full
