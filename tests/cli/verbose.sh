isorender scene:torus:32 out.png --verbose --resolution 32x32 2>log
grep -q 'points in' log
grep -q 'load .* s, extract .* s, render .* s, write .* s' log
