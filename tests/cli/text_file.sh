echo "this is not a volume" >in/a.txt
isorender in/a.txt
