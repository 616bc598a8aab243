# exit: 1
# stderr: isocompare: in/b.png: psnr_in is *, not at least 90; flip is *, not at most 1e-06
isorender scene:torus:32 in/a.png --resolution 90x90 --method raycast --quiet
isorender scene:torus:32 in/b.png --resolution 90x90 --method points --quiet
isocompare images in/a.png in/b.png --quiet --fail-under psnr=1 --fail-under psnr_in=90 --fail-under flip=0.000001
