isocompare report scene:torus:32
