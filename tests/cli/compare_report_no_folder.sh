echo x >in/file
isocompare report scene:torus:32 --output in/file
