# exit: 2
# stderr: isorender: --ior draws one surface, as glass: it cannot be combined with several isovalues
isorender scene:ct:16 a.png --ior 1.5 --isovalue 100,200
