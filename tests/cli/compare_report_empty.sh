isocompare report scene:torus:32 --output made --side 64 --isovalue 1000 --quiet
