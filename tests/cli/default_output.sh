python3 -c 'from check import *; ball("in/a.b.mha")'
isorender in/a.b.mha --resolution 32x32 --quiet
[ -f a.b.png ]
cp in/a.b.mha in/c.mha
isorender in/a.b.mha in/c.mha --resolution 32x32 --quiet --output '{n:3}_{model}.png' --json='{model}.json'
[ -f 000_a.b.png ] && [ -f 001_c.png ] && [ -f a.b.json ] && [ -f c.json ]
