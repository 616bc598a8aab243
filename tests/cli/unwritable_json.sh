# exit: 7
# stderr: isorender: in/missing/out.json: cannot write: *
isorender scene:torus:32 --json=in/missing/out.json
