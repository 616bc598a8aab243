# exit: 2
# stderr: isocompare: option --fail-under: 'beauty' is not one of psnr_in, *
isocompare images a.png b.png --fail-under beauty=3
