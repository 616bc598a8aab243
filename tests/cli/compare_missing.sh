isocompare images nowhere.png neither.png
