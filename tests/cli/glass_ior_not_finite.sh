# exit: 2
# stderr: isorender: option --ior: 'nan' *
isorender scene:sphere:16 a.png --ior nan
