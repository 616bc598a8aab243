# stdout: isorender [0-9]*.[0-9]*.[0-9]*
isorender --version
