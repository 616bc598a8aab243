: >in/a.vti
isorender in/a.vti
