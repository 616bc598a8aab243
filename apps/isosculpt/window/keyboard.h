/* keyboard: what mouse and keys do, as X(input, effect), for the help in the window and the man page. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_KEYBOARD_H
#define ISO_APPS_ISOSCULPT_WINDOW_KEYBOARD_H

#define ISOSCULPT_KEYS(X)                                                                                    \
    X("left drag on the surface", "the brush; on a volume that is not sculpted yet: orbit")                  \
    X("left drag beside it, middle drag", "orbit")                                                           \
    X("right drag, arrow keys", "pan")                                                                       \
    X("wheel, +  -", "zoom")                                                                                 \
    X("F, Shift+F", "the whole object in the picture; what is under the cursor in its middle")               \
    X("Shift+1, 3, 7", "look from the front, right, top (number pad: without Shift)")                        \
    X("Ctrl+1, 3, 7", "look from the back, left, bottom (number pad, too)")                                  \
    X("1 .. 9, 0, T, L, W, J, P", "brushes; picking one makes a volume a field to sculpt")                   \
    X("B, A", "trim by a line, by a lasso: drag over the picture; with Alt the other side of it")            \
    X("Shift + left drag", "smooth")                                                                         \
    X("Alt or Ctrl + left drag", "the brush, inverted")                                                      \
    X("Alt + click on the surface", "select the stroke that made it, to change it (Strokes, in the panel)")  \
    X("Delete", "delete the selected strokes")                                                               \
    X("[  ] or ,  .", "smaller, larger brush")                                                               \
    X("X, C + moving the mouse", "size, strength")                                                           \
    X("E", "the colour under the cursor becomes the brush's")                                                \
    X("Ctrl+I, Alt+M", "invert the mask, clear it")                                                          \
    X("D", "measure: clicks on the surface say how thick and how far apart places are")                      \
    X("Escape", "take back the stroke, close a list, cancel opening or saving, select no stroke")            \
    X("Ctrl+Z, Ctrl+Shift+Z or Ctrl+Y", "undo, redo")                                                        \
    X("Ctrl+O, Ctrl+N", "open a file, begin with a new solid")                                               \
    X("Ctrl+S, Ctrl+Shift+S", "save; save as .vdb (level set), .stl, .ply or .obj (meshes)")                 \
    X("Ctrl+Q", "close")                                                                                     \
    X("M, G", "next method, next engine")                                                                    \
    X("R", "x-ray: the surface as it was when the session began, translucent; or --reference")               \
    X("K", "a plane that cuts, or no longer: drag its handle to move it, its arrow's tip to tilt it")        \
    X("O", "ambient occlusion in the picture at rest")                                                       \
    X("F12, Shift+F12", "picture of the sculpture, of the window; beside the file that is saved")            \
    X("Tab, H", "panel, this sheet")                                                                         \
    X("dropping a file", "opens it; a mesh can also become a stamp")

#endif
