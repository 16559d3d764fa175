# Install rules: libraries, public headers, and what find_package(winnow) and pkg-config read.

include(CMakePackageConfigHelpers)

set(winnow_modules winnow_core winnow_simd winnow_partitions winnow_pipeline)
# A shared module finds its siblings beside itself, wherever the tree is moved to.
set_target_properties(${winnow_modules} PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
  INSTALL_RPATH $ORIGIN)
install(TARGETS ${winnow_modules} winnow EXPORT winnow-targets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})

foreach(header ${WINNOW_PUBLIC_HEADERS})
  string(REPLACE "pipeline/winnow.h" "winnow.h" public ${header})
  get_filename_component(room winnow/${public} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${room})
endforeach()

set(winnow_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/winnow)
install(EXPORT winnow-targets NAMESPACE winnow:: DESTINATION ${winnow_package_dir})
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/winnow-config.cmake.in ${PROJECT_BINARY_DIR}/winnow-config.cmake
  INSTALL_DESTINATION ${winnow_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/winnow-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/winnow-config.cmake
              ${PROJECT_BINARY_DIR}/winnow-config-version.cmake
        DESTINATION ${winnow_package_dir})

# Archives leave TBB and qhull to whoever links them; shared modules carry them themselves.
set(winnow_pc_others tbb)
if(WINNOW_WITH_QHULL)
  string(APPEND winnow_pc_others ", qhull_r")
endif()
if(BUILD_SHARED_LIBS)
  set(winnow_pc_requires "Requires: eigen3\nRequires.private: ${winnow_pc_others}")
else()
  set(winnow_pc_requires "Requires: eigen3, ${winnow_pc_others}")
endif()
file(RELATIVE_PATH winnow_pc_to_prefix
     ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(${CMAKE_CURRENT_LIST_DIR}/winnow.pc.in ${PROJECT_BINARY_DIR}/winnow.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/winnow.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
