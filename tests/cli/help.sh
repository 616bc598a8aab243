isorender --help | grep -q -- '--isovalue V'
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
