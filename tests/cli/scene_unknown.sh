isorender scene:nose out.png
