python3 -c 'from check import *; ball("in/ball.mha")'
for method in exact points discs pullpush mesh raycast; do
    for threads in 1 2 7; do
        isorender in/ball.mha $method$threads.png --method $method --threads $threads --samples 4 --resolution 200x150 --quiet
    done
    cmp ${method}1.png ${method}2.png
    cmp ${method}1.png ${method}7.png
done
! cmp -s points1.png mesh1.png
! cmp -s mesh1.png raycast1.png
