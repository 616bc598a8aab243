isorender -
