/* What mouse and keys do: for the help sheet and the man page. */
#ifndef ISO_APPS_ISOSCULPT_KEYS_H
#define ISO_APPS_ISOSCULPT_KEYS_H

#define ISOSCULPT_KEYS(X)                                                                                    \
    X("left drag on the surface", "the brush")                                                               \
    X("left drag beside it, middle drag", "orbit")                                                           \
    X("right drag", "pan")                                                                                   \
    X("wheel", "zoom")                                                                                       \
    X("Shift + left drag", "smooth")                                                                         \
    X("Alt or Ctrl + left drag", "the brush, inverted")                                                      \
    X("[  ]", "smaller, larger brush")                                                                       \
    X("X, C + moving the mouse", "size, strength")                                                           \
    X("1 .. 9", "brushes")                                                                                   \
    X("Escape", "take back the stroke, cancel opening or saving")                                            \
    X("Ctrl+Z, Ctrl+Shift+Z or Ctrl+Y", "undo, redo")                                                        \
    X("Ctrl+S, Ctrl+Q", "save as .vdb, close")                                                               \
    X("F", "look at what is under the cursor, or at all")                                                    \
    X("number pad 1, 3, 7", "front, right, top")                                                             \
    X("M, G", "next method, next engine")                                                                    \
    X("F12, Shift+F12", "picture of the sculpture, of the window")                                           \
    X("Tab, H", "panel, this sheet")                                                                         \
    X("dropping a file", "opens it; a mesh can also become a stamp")

#endif
