# exit: 2
# stderr: isorender: scene:nose: no scene 'nose'*sphere*
isorender scene:nose out.png
