isorender --isovale 3 x.vti
