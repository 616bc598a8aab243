# exit: 5
# stderr: isorender: in/1.isokeys: 1024 x 1024 keys need 8 MB, limit is 1 MB (--max-memory)
isorender scene:ct:48 --part 1/1 -o in/1.isokeys --samples 1 --quiet
isorender merge in/1.isokeys -o a.png --max-memory 1M
