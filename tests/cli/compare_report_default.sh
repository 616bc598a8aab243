# Without --output the report goes to a folder that is named after the volume; each step says which of how many it is.
isocompare report scene:torus:32 --side 64 2>log
[ -s torus-report/report.json ]
steps=$(grep -c 'isocompare: step [0-9]* of [0-9]*: ' log)
grep -q "step 1 of $steps: reading" log
grep -q "step $steps of $steps: " log
grep -q 'dB<br>FLIP [0-9.]*<br>IoU [0-9.]*<br>' torus-report/report.html
grep -q '@media(max-width:1350px)' torus-report/report.html
