# Installs the build tree BUILD below WORK, then configures, builds and runs the project SOURCE against it. Fails if anything of src/ or
# any private path got into the installed tree, or if a program that uses internals compiles.
file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    string(REPLACE ";" " " command "${ARGV}")
    message(FATAL_ERROR "failed (${status}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

# The headers stand alone: no third-party header, nothing of src/.
file(GLOB headers ${prefix}/include/sightline/*.h)
if(NOT headers)
  message(FATAL_ERROR "no public header was installed")
endif()
foreach(header IN LISTS headers)
  file(STRINGS ${header} includes REGEX "^#[ \t]*include")
  foreach(line IN LISTS includes)
    if(NOT line MATCHES "<[a-z_]+>" AND NOT line MATCHES "\"sightline/[a-z_]+\\.h\"")
      message(FATAL_ERROR "${header} includes more than the standard library and sightline/: ${line}")
    endif()
  endforeach()
endforeach()
# The package can be moved: no path of the build tree in what was installed for CMake.
file(GLOB_RECURSE package_files ${prefix}/lib/*.cmake ${prefix}/lib64/*.cmake)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(FIND "${text}" "${BUILD}" position)
  if(NOT position EQUAL -1)
    message(FATAL_ERROR "${file} names the build tree")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${WORK}/build --target consumer)
run(${WORK}/build/consumer)
string(FIND "${output}" "sightline ${VERSION}" position)
if(position EQUAL -1)
  message(FATAL_ERROR "the consumer printed '${output}' instead of version ${VERSION}")
endif()

# What must not compile: internals are not reachable through the package.
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target uses_internals RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
if(status EQUAL 0)
  message(FATAL_ERROR "a program that includes an internal header compiled against the installed package")
endif()
