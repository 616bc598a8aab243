isorender scene:sphere:32 out.png --strips --method mesh --backend cpu
