isorender a.vti b.vti c.vti
