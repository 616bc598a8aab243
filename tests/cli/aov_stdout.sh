# exit: 2
# stderr: isorender: -: --aov writes OpenEXR files*
isorender scene:torus:32 out.png --aov -
