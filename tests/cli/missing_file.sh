isorender in/missing.vti
