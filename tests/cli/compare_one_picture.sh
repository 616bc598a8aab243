isocompare images a.png
