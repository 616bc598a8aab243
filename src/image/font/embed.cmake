# Writes the font as a C file with the array iso_font_file (image/font.h). Usage: cmake -DOUT=file.c -DFONT=sans.ttf -P embed.cmake
cmake_minimum_required(VERSION 3.25)
file(READ ${FONT} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "#include \"image/font.h\"\n\nconst uint8_t iso_font_file[] = {\n${bytes}\n};\n"
    "const size_t iso_font_file_bytes = sizeof iso_font_file;\n")
