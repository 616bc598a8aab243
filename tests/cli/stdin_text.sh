# exit: 3
# stderr: isorender: standard input: *
echo "this is not a volume" | isorender - out.png
