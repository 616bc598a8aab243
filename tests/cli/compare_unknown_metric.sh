isocompare images a.png b.png --fail-under beauty=3
