# libsightline, made of the objects of every layer, and the package that `cmake --install` gives: Sightline::sightline with the headers of
# include/sightline/. Nothing of src/ is installed.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

option(BUILD_SHARED_LIBS "Build libsightline as a shared library" OFF)
add_library(sightline)
add_library(Sightline::sightline ALIAS sightline)
set_target_properties(sightline PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_features(sightline PUBLIC cxx_std_20)
target_include_directories(sightline PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# Only what is compiled code is linked; header-only libraries have done their work in the layers' objects.
set(SIGHTLINE_HEADER_ONLY glm::glm Eigen3::Eigen nlohmann_json::nlohmann_json CLI11::CLI11 fmt::fmt-header-only sightline_options)
foreach(layer IN LISTS SIGHTLINE_BUILT_LAYERS)
  target_sources(sightline PRIVATE $<TARGET_OBJECTS:sightline_${layer}>)
  get_target_property(libraries sightline_${layer} LINK_LIBRARIES)
  foreach(library IN LISTS libraries)
    if(NOT library MATCHES "^sightline_" AND NOT library IN_LIST SIGHTLINE_HEADER_ONLY)
      list(APPEND SIGHTLINE_LINKED ${library})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES SIGHTLINE_LINKED)
target_link_libraries(sightline PRIVATE ${SIGHTLINE_LINKED})
# The library is only for those who install it; programs and tests of the project link the layers.
set_target_properties(sightline PROPERTIES LINKER_LANGUAGE CXX)

install(TARGETS sightline EXPORT SightlineTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/sightline ${PROJECT_BINARY_DIR}/generated/sightline
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Sightline)
install(EXPORT SightlineTargets NAMESPACE Sightline:: DESTINATION ${package_folder})
configure_package_config_file(cmake/SightlineConfig.cmake.in ${PROJECT_BINARY_DIR}/SightlineConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/SightlineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/SightlineConfig.cmake ${PROJECT_BINARY_DIR}/SightlineConfigVersion.cmake
  DESTINATION ${package_folder})
