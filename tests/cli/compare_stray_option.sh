# exit: 2
# stderr: isocompare: --fail-under does not belong to report
isocompare report scene:torus:32 --output made --fail-under psnr=3
