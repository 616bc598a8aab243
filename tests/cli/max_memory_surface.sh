# exit: 5
# stderr: isorender: scene:gyroid:96: *limit is 5 MB (--max-memory)
isorender scene:gyroid:96 a.png --method points --resolution 64x64 --max-memory 5M
