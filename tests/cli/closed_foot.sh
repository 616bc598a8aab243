# exit: 2
# stderr: isorender: --closed makes edge points: --primitive foot has no caps
isorender scene:sphere sphere.png --closed --primitive foot
