# --help WORD finds options by what others call them, in either case, with blanks or dashes; several unknown options are counted.
for word in grey 'cut open' 'Scale Bar' subplot; do
    isorender --help "$word" >"$word.txt"
done
grep -q '^  --cap ' grey.txt
grep -q '^  --clip ' 'cut open.txt'
grep -q '^  --scale-bar' 'Scale Bar.txt'
grep -q '^  --panels ' subplot.txt
# An option of the word's name comes before those that only speak of it.
isorender --help method >method.txt
head -n 1 method.txt | grep -q '^  --method NAME'
isorender --help fiber >fiber.txt
head -n 1 fiber.txt | grep -q '^  --lines FILE'
rm ./*.txt
isorender_refuses 2 "--help: no option speaks of 'xyzzy'" --help xyzzy
options=$(seq -f '--unknown-option-of-nobody-%g=1' 40)
isorender_refuses 2 ", and [1-9][0-9]* more" $options
