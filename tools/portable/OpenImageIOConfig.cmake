# SPDX-License-Identifier: GPL-3.0-or-later
#
# What find_package(OpenImageIO) finds in the preset `portable`: the part of the interface that the
# core uses, and no reader behind it. Debian's OpenImageIO needs 240 other libraries, 140 MB as a
# zip file; a package cannot bring those, so Blender decodes the images (addon/export/image.py).
if(NOT TARGET OpenImageIO::OpenImageIO)
    add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
    set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
        INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_LIST_DIR})
endif()
