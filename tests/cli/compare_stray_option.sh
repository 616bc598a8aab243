isocompare report scene:torus:32 --output made --fail-under psnr=3
