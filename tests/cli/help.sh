# A first page of at most 25 lines; topics, words and forms.
isorender --help >first
[ "$(wc -l <first)" -le 25 ] || { wc -l first; exit 1; }
for topic in input surface points lines picture camera output running papers files exit examples; do
    grep -qw "$topic" first || { echo "the first page does not name $topic"; exit 1; }
    isorender --help $topic >$topic
    [ -s $topic ]
done
grep -q -- '--isovalue V' surface
! grep -q -- '--isovalue V' camera
grep -q -- '--group-bins N' papers
isorender --help CAMERA | cmp - camera
isorender --help=camera | cmp - camera
isorender help camera | cmp - camera
isorender --help transparent | grep -q -- '--background COLOR'
isorender --help tube | grep -q -- '--tube-radius'
refuses 2 "no option speaks of 'xyzzy'; topics are input, surface" isorender --help xyzzy
isorender --help all >all
grep -q -- '--isovalue V' all
[ "$(wc -l <all)" -gt 300 ]
isorender --help=markdown | grep -q '^| `--isovalue V` |'
isorender --help=man >isorender.1
grep -q '^.TH ISORENDER 1' isorender.1
if command -v groff >/dev/null; then
    groff -man -Tascii -ww isorender.1 2>warnings >page
    [ ! -s warnings ] || { cat warnings; exit 1; }
    grep -q 'OUT.png' page
fi
isorender --help=bash >completion
bash -c '. ./completion; COMP_WORDS=(isorender --method m); COMP_CWORD=2; _isorender; [ "${COMPREPLY[*]}" = mesh ]'
bash -c '. ./completion; COMP_WORDS=(isorender --turn); COMP_CWORD=1; _isorender; [ "${COMPREPLY[*]}" = --turntable ]'
[ "$(isosculpt --help | wc -l)" -le 25 ]
isosculpt --help mouse | grep -q 'Ctrl'
