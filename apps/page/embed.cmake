# Embeds files: writes a C file with the table iso_page_files (apps/common/page_files.h) of names and bytes.
# Usage: cmake -DOUT=file.c -DFILES=a;b -P embed.cmake
cmake_minimum_required(VERSION 3.25)
set(arrays "")
set(table "")
set(number 0)
foreach(file ${FILES})
    get_filename_component(name ${file} NAME)
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
    string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes
        "${bytes}")
    string(APPEND arrays "static const unsigned char file${number}[] = {\n${bytes}};\n")
    string(APPEND table "    {\"${name}\", file${number}, sizeof file${number}},\n")
    math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "#include \"apps/common/page_files.h\"\n\n${arrays}
const iso_page_file iso_page_files[] = {\n${table}    {0, 0, 0}};\n")
