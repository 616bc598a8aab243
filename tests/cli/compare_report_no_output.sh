# exit: 2
# stderr: isocompare: report needs --output DIR
isocompare report scene:torus:32
