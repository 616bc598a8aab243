isorender scene:torus:32 out.png --progress --resolution 32x32 --turntable 10 2>log
grep -q 'rendering 40 %' log
grep -q 'rendering 100 %' log
! grep -q $'\r' log
