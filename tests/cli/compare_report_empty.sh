# exit: 6
# stderr: isocompare: scene:torus:32: no surface at isovalue 1000: the level set's narrow band is 3 mm wide on either side
isocompare report scene:torus:32 --output made --side 64 --isovalue 1000 --quiet
