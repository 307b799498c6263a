# Unity builds by folder: with SIGHTLINE_UNITY the sources of one folder are compiled as one, which takes a third of the time of compiling them
# apart, since most of that is reading headers and instantiating what is in them. Folders, and not batches of some number of files, so that it does
# not depend on a list's order whether two names meet: names in anonymous namespaces are unique within a folder, and may repeat in others.

option(SIGHTLINE_UNITY "Compile the sources of a folder together: fast for whole builds, slow after an edit" OFF)

# sightline_unity(TARGET): groups the target's sources, wherever they were added. Files that Highway compiles once for every instruction set
# (foreach_target.h) include themselves and stay apart.
function(sightline_unity target)
  if(NOT SIGHTLINE_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  foreach(source IN LISTS sources)
    if(NOT source MATCHES "\\.cpp$")
      continue()
    endif()
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} NORMALIZE)
    set(apart "")
    if(EXISTS ${source})
      file(STRINGS ${source} apart REGEX "hwy/foreach_target\\.h" LIMIT_COUNT 1)
    endif()
    if(apart)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      cmake_path(GET source PARENT_PATH group)
      file(RELATIVE_PATH group ${PROJECT_SOURCE_DIR} ${group})
      string(MAKE_C_IDENTIFIER ${group} group)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
