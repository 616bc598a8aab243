isorender scene:torus:32 --json=in/missing/out.json
