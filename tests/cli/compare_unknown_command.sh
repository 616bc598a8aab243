# exit: 2
# stderr: isocompare: there is no command 'pictures': *
isocompare pictures a.png b.png
