isorender in/a.vti --output "{modle}.png"
