# find_package(posewise) gives the target posewise::posewise and posewise_MODEL, the model's file.
# The target is the static library, or with POSEWISE_SHARED the shared one. Paths are found from
# this file, so an installed tree may be moved.
get_filename_component(_posewise_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(posewise_MODEL "${_posewise_prefix}/share/posewise/posewise.posewise")

if(POSEWISE_SHARED)
  set(_posewise_kind SHARED)
  set(_posewise_file "${_posewise_prefix}/lib/libposewise.so")
else()
  set(_posewise_kind STATIC)
  set(_posewise_file "${_posewise_prefix}/lib/libposewise.a")
endif()
if(NOT EXISTS "${_posewise_file}")
  set(posewise_FOUND FALSE)
  set(posewise_NOT_FOUND_MESSAGE "There is no ${_posewise_file}")
elseif(NOT TARGET posewise::posewise)
  add_library(posewise::posewise ${_posewise_kind} IMPORTED)
  set_target_properties(posewise::posewise PROPERTIES
    IMPORTED_LOCATION "${_posewise_file}"
    IMPORTED_LINK_INTERFACE_LANGUAGES C
    INTERFACE_INCLUDE_DIRECTORIES "${_posewise_prefix}/include")
endif()
unset(_posewise_prefix)
unset(_posewise_kind)
unset(_posewise_file)
