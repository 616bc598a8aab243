# exit: 2
# stderr: isorender: 3 inputs need --output TEMPLATE, such as '{model}.png'
isorender a.vti b.vti c.vti
