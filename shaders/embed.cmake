# Embeds shader files into the library: writes a C file with the table iso_gl_texts (render/gl/program.h) of
# file names and texts. Usage: cmake -DOUT=file.c -DFILES=a;b -P embed.cmake
cmake_minimum_required(VERSION 3.25)
set(table "")
foreach(file ${FILES})
    get_filename_component(name ${file} NAME)
    file(READ ${file} text)
    string(REPLACE "\\" "\\\\" text "${text}")
    string(REPLACE "\"" "\\\"" text "${text}")
    string(REPLACE "\n" "\\n\"\n     \"" text "${text}")
    string(APPEND table "    {\"${name}\",\n     \"${text}\"},\n")
endforeach()
file(WRITE ${OUT} "#include \"render/gl/program.h\"\n\nconst iso_gl_text iso_gl_texts[] = {\n${table}    {0, 0}};\n")
