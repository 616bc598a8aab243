# Files are opened by iso_file_open and iso_file_descriptor (src/base/file.h), which never wait for a FIFO and refuse what is no
# regular file. Only the files below may call the system or a library for it. Usage: cmake -DROOT=<source folder> -P opens.cmake
cmake_minimum_required(VERSION 3.25)
set(allowed
    src/base/file.c src/base/temporary_file.c
    src/base/cgroup.c apps/isocompare/machine.c grids/volume/hdf5/guard.c # /proc, /sys, /dev/null
    src/scene/input_spool.c # the main input, which may be a FIFO
    src/sculpt/session/journal.c apps/isosculpt/document.c # files that are locked and written to
    # Libraries that open by name, after iso_file_open has opened the same file:
    grids/volume/format_nifti.c grids/volume/vdb_archive.cc grids/volume/hdf5/library.c)

set(bad "")
set(seen 0)
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/src/*.[ch]* ${ROOT}/grids/*.[ch]* ${ROOT}/apps/*.[ch]*)
foreach(file ${files})
    if(NOT file MATCHES "\\.(c|cc|h|hpp|inc)$" OR file IN_LIST allowed)
        continue()
    endif()
    math(EXPR seen "${seen} + 1")
    file(STRINGS ${ROOT}/${file} lines REGEX
        "(^|[^A-Za-z0-9_])(fopen|freopen|open|openat|creat|gzopen|znzopen|BZ2_bzopen|TIFFOpen|TIFFOpenExt|H5Fopen)\\(|[io]?fstream [A-Za-z_]+[({]")
    foreach(line ${lines})
        if(NOT line MATCHES "^ *(\\*|/\\*|//)")
            string(STRIP "${line}" line)
            list(APPEND bad "${file}: ${line}")
        endif()
    endforeach()
endforeach()
if(seen EQUAL 0)
    message(FATAL_ERROR "no file was found below ${ROOT}: nothing was checked")
endif()
if(bad)
    list(JOIN bad "\n" text)
    message(FATAL_ERROR "a file is opened by something else than iso_file_open (base/file.h):\n${text}")
endif()
message("${seen} files open no file by themselves")
