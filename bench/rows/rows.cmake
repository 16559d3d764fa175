# Facts about the build for reports: versions from the configuration, and the commit from each
# build.
set(winnow_dependencies "")
foreach(library Eigen3 TBB nlohmann_json)
  if(${library}_VERSION)
    list(APPEND winnow_dependencies "${library} ${${library}_VERSION}")
  endif()
endforeach()
find_program(WINNOW_DPKG_QUERY dpkg-query)
foreach(package libxsimd-dev libbullet-dev libfcl-dev libcgal-dev libembree-dev libode-dev
                libccd-dev)
  if(WINNOW_DPKG_QUERY)
    execute_process(COMMAND ${WINNOW_DPKG_QUERY} -W -f "\${Version}" ${package}
                    OUTPUT_VARIABLE version RESULT_VARIABLE absent ERROR_QUIET)
    if(NOT absent AND version)
      string(REGEX REPLACE "^lib|-dev$" "" name ${package})
      list(APPEND winnow_dependencies "${name} ${version}")
    endif()
  endif()
endforeach()
list(JOIN winnow_dependencies ", " winnow_dependencies)
get_property(winnow_peers_text TARGET winnow_peers PROPERTY WINNOW_PEERS_FOUND)
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
string(STRIP "${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}" build)

add_custom_target(winnow_build_facts
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR}
          -DOUT=${CMAKE_CURRENT_BINARY_DIR}/build_facts.cpp
          -DWINNOW_VERSION=${PROJECT_VERSION} "-DWINNOW_BUILD_TYPE=${build}" "-DWINNOW_DEPENDENCIES=${winnow_dependencies}"
          "-DWINNOW_PEERS=${winnow_peers_text}"
          -P ${CMAKE_CURRENT_LIST_DIR}/build_facts.cmake
  BYPRODUCTS ${CMAKE_CURRENT_BINARY_DIR}/build_facts.cpp VERBATIM)
