isorender --backend egl in/a.vti
