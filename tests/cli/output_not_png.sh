isorender in/a.vti b.jpg
