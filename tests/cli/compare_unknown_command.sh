isocompare pictures a.png b.png
