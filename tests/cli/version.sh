isorender --version
