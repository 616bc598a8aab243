# exit: 2
# stderr: isorender: unknown option --isovale (did you mean --isovalue[?])
isorender --isovale 3 x.vti
