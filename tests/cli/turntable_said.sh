# A turntable says the names of its first and last pictures.
isorender scene:sphere:16 ball.png --turntable 12 --resolution 8x8 2>said
grep -q "wrote ball_000.png to ball_011.png$" said
isorender scene:sphere:16 -o 'view_{n}.png' --aov 'depth_{n:2}.exr' --turntable 2 --resolution 8x8 2>said
grep -q "wrote view_0.png to view_1.png$" said
grep -q "wrote depth_00.exr to depth_01.exr$" said
isorender scene:sphere:16 one.png --turntable 1 --resolution 8x8 2>said
grep -q "wrote one" said && [ "$(ls one*)" = one_000.png ]
