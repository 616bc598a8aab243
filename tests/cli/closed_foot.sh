isorender scene:sphere sphere.png --closed --primitive foot
