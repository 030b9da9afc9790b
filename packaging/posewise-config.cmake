# find_package(posewise) gives the target posewise::posewise and posewise_MODEL, the model's file.
# Paths are found from this file, so an installed tree may be moved.
get_filename_component(_posewise_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(posewise_MODEL "${_posewise_prefix}/share/posewise/default.posewise")

if(NOT TARGET posewise::posewise)
  add_library(posewise::posewise STATIC IMPORTED)
  set_target_properties(posewise::posewise PROPERTIES
    IMPORTED_LOCATION "${_posewise_prefix}/lib/libposewise.a"
    IMPORTED_LINK_INTERFACE_LANGUAGES C
    INTERFACE_INCLUDE_DIRECTORIES "${_posewise_prefix}/include")
endif()
unset(_posewise_prefix)
