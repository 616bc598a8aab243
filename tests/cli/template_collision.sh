isorender in/a.vti in/a.mha --output "{model}.png"
