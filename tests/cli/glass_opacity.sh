# exit: 2
# stderr: isorender: --ior draws one surface, as glass: it cannot be combined with --opacity
isorender scene:sphere:16 a.png --ior 1.5 --opacity 0.5
