# Braces in the name of an input are part of the name: only what is typed as a name of an output is a template.
python3 -c 'from check import *; ball("in/scan {1}.mha", side=12, radius=3.0)'
cp 'in/scan {1}.mha' 'in/{n:3}.mha'
cp 'in/scan {1}.mha' 'in/{model}{.mha'
options='--resolution 16x16 --isovalue 500'
for name in 'scan {1}' '{n:3}' '{model}{'; do
    isorender "in/$name.mha" $options --json=o.json 2>said
    [ -f "$name.png" ] && grep -qF "wrote $name.png" said && grep -qF "\"path\": \"$name.png\"" o.json
    isorender "in/$name.mha" $options -o 'a {model} {n}.png' --points 'p {model}.ply' -q
    [ -f "a $name 0.png" ] && [ -f "p $name.ply" ]
    isorender "in/$name.mha" $options --turntable 2 2>said
    [ -f "${name}_000.png" ] && [ -f "${name}_001.png" ]
    grep -qF "wrote ${name}_000.png to ${name}_001.png" said
done
[ ! -f 000.png ] && [ "$(ls | grep -c png)" -eq 12 ]
# One picture of a template with a number has the number, as the first of several has.
isorender scene:sphere:16 -o '{n}.png' $options 2>said || true
isorender 'in/scan {1}.mha' -o '{n}.png' $options 2>said
[ -f 0.png ] && grep -q 'wrote 0.png$' said
