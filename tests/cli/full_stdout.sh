isorender --help >/dev/full
