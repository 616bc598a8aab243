# exit: 3
# stderr: isocompare: nowhere.png: *
isocompare images nowhere.png neither.png
