# exit: 2
# stderr: isorender: out.tiff: --aov writes OpenEXR files*
isorender scene:torus:32 out.png --aov out.tiff
