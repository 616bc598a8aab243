echo "this is not a volume" | isorender - out.png
