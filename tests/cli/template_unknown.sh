# exit: 2
# stderr: isorender: {modle}.png: '{modle}' is not {model}, {n} or {n:DIGITS}
isorender in/a.vti --output "{modle}.png"
