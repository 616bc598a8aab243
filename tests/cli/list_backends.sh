isorender --list-backends --threads 3
