isorender scene:torus:32 out.png --verbose --resolution 32x32 2>log
grep -q 'cells in' log
isorender scene:torus:32 out.png --method points --verbose --resolution 32x32 2>&1 | grep -q 'points in'
grep -q 'load .* s, extract .* s, render .* s, write .* s' log
