# exit: 2
# stderr: isocompare: images takes two pictures, the truth first
isocompare images a.png
